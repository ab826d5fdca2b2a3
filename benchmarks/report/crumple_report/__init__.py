"""Tables, plots and docs/benchmarks.md from the figures of scripts/bench.sh."""
