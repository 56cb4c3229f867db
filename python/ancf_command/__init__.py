"""The console's entry to `ancf`: what it imports takes most of a second, in which a signal must find someone, too."""

import signal
import sys


def main() -> int:
    """Run the command line.

    Returns
    -------
    int
        The exit status.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        from ancf.cli import main as run  # noqa: PLC0415  As above.

        return run()
    except KeyboardInterrupt:
        if sys.stderr is not None:
            print("ancf: interrupted", file=sys.stderr)
        return 130
