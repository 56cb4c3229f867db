"""Published examples, run again: ours beside the figures of the paper. One package for each paper."""
