"""The doctor's judgement of what programs say of themselves: versions, schema, rights, certificates, clocks."""

from collections.abc import Mapping
from typing import Any

from farhand.common.link.presence import about
from farhand.common.trust.certificate import WARN_DAYS
from farhand.common.trust.tls import TlsFolder
from farhand.site.findings import Finding

CLOCK_DIFFERENCE = 3600.0
_SAME = "install the same farhand on all hosts"


def judge(where: str, facts: Mapping[str, Any], own: Mapping[str, Any]) -> list[Finding]:
    """What is to be said of one program on the way.

    Args:
        where: whose, for the reader, such as "robot".
        facts: what it answered to the `about` question.
        own: the same of this program.
    """
    return [
        versions(where, facts, own),
        rights(where, facts),
        *_certificate_days(where, facts),
        *_clock(where, facts, own),
    ]


def versions(where: str, facts: Mapping[str, Any], own: Mapping[str, Any]) -> Finding:
    """Whether both speak the same messages, and are of the same version."""
    if facts.get("schema") != own["schema"]:
        found = f"{where} speaks schema {facts.get('schema')}, this host {own['schema']}"
        return Finding("bad", f"schema, {where}", found, _SAME)
    if (facts.get("farhand"), facts.get("zenoh")) != (own["farhand"], own["zenoh"]):
        there, here = (f"farhand {each.get('farhand')} on Zenoh {each.get('zenoh')}" for each in (facts, own))
        found = f"{there}; here {here}"
        return Finding("note", f"versions, {where}", found, f"better {_SAME}")
    found = f"farhand {own['farhand']}, Zenoh {own['zenoh']}, schema {own['schema']} as here"
    return Finding("good", f"versions, {where}", found)


def rights(where: str, facts: Mapping[str, Any]) -> Finding:
    """Whether it may run in real time."""
    if facts.get("realtime"):
        return Finding("good", f"scheduling, {where}", "SCHED_FIFO is granted")
    remedy = "allow it: rtprio 20 in /etc/security/limits.d, or LimitRTPRIO=20 in the systemd unit"
    return Finding("note", f"scheduling, {where}", "SCHED_FIFO is not granted: late ticks under load", remedy)


def own_certificate(folder: TlsFolder, robot: str) -> list[Finding]:
    """What is to be said of this program's certificate folder."""
    own = folder.own
    findings = [Finding("good", "certificate", f"{own.name}, until {own.end} ({own.days_left:.0f} days)")]
    if own.robots and robot not in own.robots:
        found = f"named for {', '.join(own.robots)}, not {robot!r}"
        findings.append(Finding("bad", "certificate", found, f"issue one with --robot {robot}"))
    for line in folder.warnings:
        remedy = "`farhand certs renew NAME`, copy the folder, restart; or set the clock, if that date is far"
        if "can be read by others" in line:
            remedy = "chmod 0600, and renew it if somebody may have read it"
        elif line.startswith("left out") and "ended" not in line and "valid before" not in line:
            remedy = "remove the file, or get the right one from the authority's folder"
        findings.append(Finding("note", "certificate", line, remedy))
    return findings


def _certificate_days(where: str, facts: Mapping[str, Any]) -> list[Finding]:
    days, name = facts.get("days_left"), facts.get("certificate")
    if not isinstance(days, (int, float)):
        return []
    what, found = f"certificate, {where}", f"{name}, {days:.0f} days left"
    remedy = f"`farhand certs renew {name}`, copy the folder there, restart; or look at the clock there"
    if days <= 0:
        return [Finding("bad", what, f"{name} has ended, by the clock there", remedy)]
    if days <= WARN_DAYS:
        return [Finding("note", what, found, remedy)]
    return [Finding("good", what, found)]


def _clock(where: str, facts: Mapping[str, Any], own: Mapping[str, Any]) -> list[Finding]:
    there = facts.get("utc")
    if not isinstance(there, (int, float)) or abs(there - own["utc"]) <= CLOCK_DIFFERENCE:
        return []
    hours = (there - own["utc"]) / 3600.0
    size = f"{abs(hours):.0f} hours" if abs(hours) < 48.0 else f"{abs(hours) / 24.0:.0f} days"
    found = f"{size} {'ahead of' if hours > 0 else 'behind'} this host's; certificates are judged by them"
    return [Finding("note", f"clock, {where}", found, "set the one that is wrong (date, NTP)")]


def this_host() -> dict[str, Any]:
    """What this program would answer."""
    return about("doctor")
