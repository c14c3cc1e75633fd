"""expect_failures.py PROGRAM LIBRARY [CHECK…]: `pileus conform` fails exactly these checks."""
import json
import subprocess
import sys


def failed_checks(program, library):
    """Exit code, and what failed with the reasons."""
    done = subprocess.run([program, "conform", library, "--json", "--time-limit", "3"],
                          capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        sys.exit(f"exit code {done.returncode}: {done.stderr}")
    checks = json.loads(done.stdout)["checks"]
    return done.returncode, {c["check"]: c["text"] for c in checks if c["verdict"] == "failed"}


def main(program, library, *checks):
    expected = [check for check in checks if check]
    code, failed = failed_checks(program, library)
    for check, text in sorted(failed.items()):
        print(check, text)
    if set(failed) != set(expected):
        sys.exit(f"failed are {sorted(failed)}, expected {sorted(expected)}")
    if code != (3 if expected else 0):
        sys.exit(f"exit code {code}")
    if any(not text for text in failed.values()):
        sys.exit("a failure gives no reason")


if __name__ == "__main__":
    main(*sys.argv[1:])
