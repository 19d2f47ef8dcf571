"""Prometheus metrics on a local port, for those who watch for hours; read at each scrape, in its thread."""

from collections.abc import Callable, Iterator

from prometheus_client import CollectorRegistry, start_http_server
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from farhand.common.errors import EndpointError
from farhand.netem.measure.result import NetemResult

_COUNTS = ("received", "delivered", "duplicated", "corrupted", "reordered", "retransmitted")
_QUANTILES = {"p50": "0.5", "p99": "0.99", "max": "1"}


class StatisticsCollector(Collector):
    """The statistics as metric families.

    Args:
        statistics: gives `NetemNode.statistics()`.
    """

    def __init__(self, statistics: Callable[[], NetemResult]) -> None:
        self._statistics = statistics

    def collect(self) -> Iterator[Metric]:
        """All families."""
        statistics = self._statistics()
        labels = ["direction", "robot"]
        counts = {
            name: CounterMetricFamily(f"farhand_netem_{name}", f"Messages {name}.", labels=labels)
            for name in _COUNTS
        }
        dropped = CounterMetricFamily("farhand_netem_dropped", "Messages dropped.", labels=[*labels, "cause"])
        queued = GaugeMetricFamily("farhand_netem_queued", "Messages that wait.", labels=labels)
        delays = {
            name: GaugeMetricFamily(f"farhand_netem_{name}_seconds", text, labels=[*labels, "quantile"])
            for name, text in (
                ("drawn", "Delay drawn."),
                ("achieved", "Delay achieved."),
                ("error", "Delay achieved minus delay assigned."),
            )
        }
        for direction, found in statistics.directions.items():
            for robot, values in found.robots.items():
                for name, family in counts.items():
                    family.add_metric([direction, robot], getattr(values, name))
                for cause, number in values.dropped.items():
                    dropped.add_metric([direction, robot, cause], number)
                queued.add_metric([direction, robot], values.queued)
                for name, gauge in delays.items():
                    for key, quantile in _QUANTILES.items():
                        gauge.add_metric([direction, robot, quantile], getattr(getattr(values, name), key))
        rtt = GaugeMetricFamily(
            "farhand_netem_rtt_seconds", "Round trip from echoed stamps.", labels=["robot", "quantile"]
        )
        for robot, trips in statistics.rtt_by_robot.items():
            for key, quantile in _QUANTILES.items():
                rtt.add_metric([robot, quantile], getattr(trips, key))
        bypassed = CounterMetricFamily(
            "farhand_netem_bypassed", "Echoes of commands that went past the emulator."
        )
        bypassed.add_metric([], statistics.bypassed)
        yield from (*counts.values(), dropped, queued, *delays.values(), rtt, bypassed)


class MetricsServer:
    """Serves the metrics over HTTP on 127.0.0.1.

    Args:
        port: free local port.
        statistics: gives `NetemNode.statistics()`.

    Raises:
        EndpointError: the port is taken.
    """

    def __init__(self, port: int, statistics: Callable[[], NetemResult]) -> None:
        registry = CollectorRegistry()
        registry.register(StatisticsCollector(statistics))
        try:
            self._server, self._thread = start_http_server(port, addr="127.0.0.1", registry=registry)
        except (OSError, OverflowError) as error:
            raise EndpointError(f"metrics port {port}: cannot be opened: {error}") from None

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(0.5)
