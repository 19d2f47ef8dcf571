"""`python -m farhand.trials.kernel.compare`: the same drive over netem's messages and over the kernel's packets.

For each network: operator, netem and robot on three hosts made of network namespaces, once with
`--backend message` and once with `--backend tc`. Needs root and a kernel with sch_netem.
"""

import argparse
import math
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import msgspec
from rich.console import Console
from rich.table import Table

from farhand.common.errors import FarhandError, InputError
from farhand.netem.spec import parse_spec
from farhand.netem.tc.backend import Device, KernelEmulation
from farhand.netem.tc.host import run_command
from farhand.netem.tc.words import kernel_network
from farhand.runs.run import Network, Run, choose_network, read_choice
from farhand.runs.scenario import Scenario, load_scenario
from farhand.trials.hosts import Hosts, why_not
from farhand.trials.kernel.drive import Drive, drive

NETWORKS = (
    "none",
    "constant:50",
    "gaussian:50,20",
    "uniform:50,200",
    "uniform:50,200 reorder:in-order",
    "constant:20 loss:5%",
    "constant:20 loss:5% tcp-like",
    "constant:20 loss:gilbert(2%,20%)",
    "constant:20 rate:256kbit",
    "lund-stockholm",
    "5g-urban",
)

HEADINGS = (
    "network",
    "backend",
    "one way (ms)",
    "lost",
    "round trip (ms): mean ± sd",
    "p50",
    "p99",
    "least clearance (mm)",
    "time (s)",
    "refused",
)


def why_no_kernel() -> str:
    """Why packets cannot be delayed here, or an empty string."""
    problem = why_not()
    if problem:
        return problem
    hosts = Hosts()
    emulation = KernelEmulation(
        [Device("to-robot", kernel_network(parse_spec("constant:1"), "uplink"))],
        lambda command, more: run_command(hosts.command_on("netem", *command), more),
    )
    try:
        emulation.start()
        emulation.stop()
    except InputError as error:
        return str(error)
    finally:
        hosts.close()
    return ""


def row(found: Drive) -> tuple[str, ...]:
    """A drive as cells."""
    if found.packets is not None:
        seen = found.packets
        way = f"packets {_ms(seen['mean'])} ± {_ms(seen['std'])}, p99 {_ms(seen['p99'])}"
    else:
        way = f"{_ms(found.drawn)} drawn, {_ms(found.achieved)} achieved"
    clearance = "-" if found.clearance is None else f"{found.clearance * 1e3:.1f}"
    time = f"{found.duration:.1f}" if found.finished else f"{found.duration:.1f}, not finished"
    return (
        found.spec,
        found.backend,
        way,
        f"{found.lost:.1%}",
        f"{_ms(found.rtt['mean'])} ± {_ms(found.rtt['std'])}",
        _ms(found.rtt["p50"]),
        _ms(found.rtt["p99"]),
        clearance if found.safe else f"{clearance} NOT SAFE",
        time,
        f"{found.refused}",
    )


def _ms(seconds: float | None) -> str:
    return "-" if seconds is None or math.isnan(seconds) else f"{seconds * 1e3:.1f}"


def networks_of(scenario: Scenario, asked: Sequence[str] | None, where: str) -> list[Network]:
    """What to drive over: what was asked for, else the scenario's own network, else eleven; raises InputError."""
    own = scenario.network
    if not asked and (own.uplink is not None or own.downlink is not None):
        return [choose_network(scenario, where=where)]
    return [choose_network(scenario, read_choice(spec)) for spec in asked or NETWORKS]


def compare(runs: Sequence[Run], packets: int, console: Console) -> list[Drive]:
    """Drive each run with each backend; what tc-netem cannot make is told, and driven without it."""
    found = []
    for run in runs:
        backends = {"message": 0, "tc": packets}
        try:
            for direction in ("uplink", "downlink"):
                kernel_network(getattr(run.network, direction).spec, direction)
        except InputError as error:
            del backends["tc"]
            console.print(str(error), markup=False)
        for backend, probes in backends.items():
            with tempfile.TemporaryDirectory(prefix="farhand-compare-") as folder:
                one = drive(run, backend, Path(folder), packets=probes)
            found.append(one)
            console.print(" | ".join(row(one)) + (f" | {one.why}" if one.why else ""), markup=False)
    return found


def main() -> int:
    """Compare, print the table; exit code 2 where this host cannot do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--network", action="append", help="SPEC, repeatable [default: scenario's, else eleven]"
    )
    parser.add_argument("--scenario", default="point-obstacle")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time-limit", type=float, default=90.0, help="of one drive, s")
    parser.add_argument("--packets", type=int, default=1000, help="probes each way before a drive with tc")
    parser.add_argument("--markdown", action="store_true", help="print the table for a document")
    parser.add_argument("--json", type=Path, help="write the results to this file as well")
    options = parser.parse_args()
    console = Console(width=200, stderr=True, markup=False)
    try:
        problem = why_no_kernel()
        if problem:
            raise InputError(problem)
        scenario = load_scenario(options.scenario)
        runs = [
            Run(scenario=scenario, network=network, seed=options.seed, time_limit=options.time_limit)
            for network in networks_of(scenario, options.network, options.scenario)
        ]
        found = compare(runs, options.packets, console)
    except FarhandError as error:
        print(f"compare: {' '.join(str(error).split())}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    if options.json:
        options.json.write_bytes(msgspec.json.encode(found))
    if options.markdown:
        print("| " + " | ".join(HEADINGS) + " |\n|" + "---|" * len(HEADINGS))
        for one in found:
            print("| " + " | ".join(row(one)) + " |")
    else:
        table = Table(*HEADINGS)
        for one in found:
            table.add_row(*row(one))
        Console(width=170, markup=False).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
