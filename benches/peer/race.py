"""gaiter against a script with trimesh, in one run: both in turn, then the instructions of gaiter.

    cargo build --profile dist --bin gaiter
    python3 benches/peer/race.py target/dist/gaiter SCAN.obj [RUNS]

SCAN.obj is in mm, y up. The script is crude_slices.py, which does a small part of the work. Prints medians:
processor time and wall time of `gaiter extract --json`, what the script needs to load and to slice, and as a
process, and the ratios. Where valgrind is installed, also the instructions of gaiter in one thread, which do
not depend on what else the machine does; those of SHA-256 are left out, because valgrind has no processor
instructions for it.
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

SCRIPT = os.path.join(os.path.dirname(__file__), "crude_slices.py")


def run(command):
    """Processor time, wall time (s) and output of a process."""
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command[0]} failed")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - began, output


def instructions(program, scan):
    """Millions of instructions of the whole process, without SHA-256."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "counts")
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}"]
        environment = dict(os.environ, RAYON_NUM_THREADS="1")
        command += [program, "extract", "--json", scan]
        subprocess.run(command, env=environment, check=True, capture_output=True)
        table = ["callgrind_annotate", "--inclusive=yes", "--threshold=99.99", out]
        text = subprocess.run(table, check=True, capture_output=True, text=True).stdout
    count = lambda line: int(line.split()[0].replace(",", ""))
    lines = text.splitlines()
    whole = next(count(line) for line in lines if line.endswith("PROGRAM TOTALS"))
    hashing = [count(line) for line in lines if "sha2::sha256::" in line]
    return (whole - max(hashing, default=0)) / 1e6


def main(program, scan, runs=15):
    gaiter, script, inner = [], [], []
    for _ in range(int(runs)):
        gaiter.append(run([program, "extract", "--json", scan])[:2])
        cpu, wall, output = run([sys.executable, SCRIPT, scan])
        figures = json.loads(output)
        script.append((cpu, wall))
        inner.append((figures["load_s"], figures["extract_s"]))
    median = lambda pairs: [1e3 * statistics.median(column) for column in zip(*pairs)]
    (cpu, wall), (script_cpu, script_wall), (load, extract) = map(median, (gaiter, script, inner))
    print("| what | CPU ms | wall ms |\n|---|---|---|")
    print(f"| `gaiter extract --json` | {cpu:.0f} | {wall:.0f} |")
    print(f"| the script: loading and slicing | – | {load:.0f} + {extract:.0f} |")
    print(f"| the script: the process | {script_cpu:.0f} | {script_wall:.0f} |")
    print(f"\nloading and slicing over gaiter's wall time: {(load + extract) / wall:.1f}")
    print(f"the script's process over gaiter's wall time: {script_wall / wall:.1f}")
    if shutil.which("valgrind"):
        print(f"instructions of gaiter in one thread: {instructions(program, scan):.0f} M")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
