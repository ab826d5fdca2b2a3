"""Tables and plots from the figures of scripts/bench.sh."""
