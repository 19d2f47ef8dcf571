"""The operator's seat, measured: see the package."""

from benchmarks.seat import main

main()
