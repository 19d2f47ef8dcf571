"""`farhand certs`: a small private certificate authority for operators, robots and emulators."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from farhand.common.errors import CertificateError
from farhand.common.process.console import page, whole

certs_app = typer.Typer(
    help="Certificates: who may steer which robot. Give each program its folder with --tls.",
    no_args_is_help=True,
)
FolderOption = Annotated[Path, typer.Option("--dir", help="The authority's folder; keep it off the robots.")]
DaysOption = Annotated[float, typer.Option(min=0.01, max=36500, help="Days of validity.")]
ForceOption = Annotated[bool, typer.Option("--force", help="Replace what is there.")]


@certs_app.command()
def init(
    folder: FolderOption = Path("certs"),
    name: Annotated[str, typer.Option(help="Name of the authority.")] = "Farhand CA",
    days: DaysOption = 3650.0,
    force: ForceOption = False,
) -> None:
    """Make the authority: its certificate and its key."""
    from farhand.site.certificates import exclusive, make_authority

    with exclusive(folder, create=True):
        made = make_authority(folder, name, days, force)
    print(f"{folder}/ca.pem: {made.name}, valid until {made.end}; {folder}/ca-key.pem is its secret")


@certs_app.command()
def issue(
    role: Annotated[str, typer.Argument(help="operator, robot, camera, netem, router or observer.")],
    name: Annotated[str, typer.Argument(help="Name of the member; a robot's is the robot's name.")],
    robot: Annotated[
        list[str] | None,
        typer.Option(help="Robot that an operator may steer, a camera show or an observer see; repeatable."),
    ] = None,
    host: Annotated[
        list[str] | None,
        typer.Option(help="Name or address at which it listens for connections; repeatable."),
    ] = None,
    folder: FolderOption = Path("certs"),
    days: DaysOption = 365.0,
    force: ForceOption = False,
) -> None:
    """Make a member's folder, to be copied to its host, and make it known in the folders of the others."""
    from farhand.site.certificates import exclusive
    from farhand.site.certificates import issue as make

    with exclusive(folder):
        made = make(folder, role, name, robot or (), host or (), days, force)
        _say_validity(folder, made, days)
    print(f"{made}: copy this folder to its host and start the program with --tls")
    print(
        f"copy {made}/cert.pem as members/{role}.{name}.pem to the hosts that deal with it, and restart those"
    )


@certs_app.command()
def show(
    folder: Annotated[Path, typer.Argument(help="An authority's or a member's folder.")] = Path("certs"),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """List certificates: name, robots, hosts, validity, and what is wrong with them."""
    from farhand.common.trust.certificate import WARN_DAYS, read_certificate, signed_by
    from farhand.site.certificates import exclusive, members

    with exclusive(folder):
        if not (folder / "ca.pem").is_file():
            raise CertificateError(
                f"{folder}: holds no certificates (no ca.pem); `farhand certs init` makes an authority"
            )
        authority = read_certificate(folder / "ca.pem")
        known = members(folder)
    rows = []
    for member in [authority, *known]:
        finding = "good"
        if not signed_by(member, authority):
            finding = "not of this authority"
        elif member.days_left <= 0:
            finding = "ended: renew"
        elif member.days_until_valid > 0:
            finding = "not valid yet: look at the clock"
        elif member.days_left <= WARN_DAYS:
            finding = "ends soon: renew"
        rows.append((member, finding))
    if as_json:
        listed = [
            {
                "name": m.name,
                "robots": m.robots,
                "hosts": m.hosts,
                "not_after": m.end,
                "days_left": m.days_left,
                "finding": finding,
            }
            for m, finding in rows
        ]
        print(json.dumps(listed))
        return
    table = Table("name", "robots", "listens at", "until", "days", "finding")
    for m, finding in rows:
        table.add_row(m.name, ", ".join(m.robots), ", ".join(m.hosts), m.end, f"{m.days_left:.0f}", finding)
    console = page()
    console.print(whole(table, console))


@certs_app.command()
def renew(
    name: Annotated[str, typer.Argument(help="Full name, such as operator.alice.")],
    folder: FolderOption = Path("certs"),
    days: DaysOption = 365.0,
) -> None:
    """Replace a member's key and certificate by new ones with the same name, robots and hosts."""
    from farhand.site.certificates import exclusive
    from farhand.site.certificates import renew as make

    with exclusive(folder):
        made = make(folder, name, days)
        _say_validity(folder, made, days)
    print(f"{made}: copy this folder to its host again, and restart the program")
    print(
        f"before the old one ends, copy {made}/cert.pem as members/{name}.pem to the hosts that deal with it"
    )
    print("the old certificate and key stay good until their own end, wherever they are")


@certs_app.command()
def zenohd(
    folder: Annotated[Path, typer.Argument(help="The folder of a certificate of the role router.")],
    listen: Annotated[list[str] | None, typer.Option(help="Endpoint to listen on; repeatable.")] = None,
    connect: Annotated[
        list[str] | None, typer.Option(help="Endpoint of another router to connect to; repeatable.")
    ] = None,
) -> None:
    """Print the configuration of a Zenoh router (zenohd) with mutual TLS and access control.

    On the router's own host, since the paths of the folder's files are in it; again when members change.
    """
    from farhand.common.link.endpoints import check_name, for_zenoh
    from farhand.common.link.zenoh_link import TIMING
    from farhand.common.trust.tls import load_folder, nested

    endpoints = [for_zenoh(endpoint) for endpoint in listen or ["tls/0.0.0.0:7447"]]
    others = [for_zenoh(check_name(endpoint)) for endpoint in connect or []]
    for option, given in (("--listen", endpoints), ("--connect", others)):
        for endpoint in given:
            if not endpoint.startswith("tls/"):
                raise CertificateError(f"{option} {endpoint}: must begin with tls/")
    settings: list[tuple[str, object]] = [
        ("mode", "router"),
        ("listen/endpoints", endpoints),
        ("connect/endpoints", others),
        ("connect/timeout_ms", -1),
        ("connect/exit_on_failure", False),
        ("scouting/multicast/enabled", False),
        ("scouting/gossip/enabled", False),
        *TIMING,
        *load_folder(folder, "router").settings("router"),
    ]
    print(json.dumps(nested(settings), indent=2))


def _say_validity(folder: Path, made: Path, asked: float) -> None:
    """Until when a certificate is valid, and why not for as long as was asked."""
    from farhand.common.trust.certificate import read_certificate

    own, authority = read_certificate(made / "cert.pem"), read_certificate(folder / "ca.pem")
    cut = f" (not for {asked:g} days: the authority itself ends then)" if asked > authority.days_left else ""
    print(f"{own.name}: valid until {own.end}{cut}")
