"""How the archive grows with its workers, by simulation: 1 to 1024 cores on a re-extraction of ten million scans.

    python3 benches/archive/scaling.py [--measure-s 0.19] [--store-mb-s 1250] ...

Each event is a request of a worker, as `gaiter-archive work` makes them: a claim of 16; for each job a beginning, the
GET of the scan, the measurement, the PUT of the result, its entry. The service times are inputs, and their defaults
were measured where it says so. Stores and databases are queues, first come, first served; neither fails, and no machine
has anything else to do. The wall is what is busy most.
"""

import argparse
import heapq
import random

SCANS = 10_000_000
CLAIM = 16
# Jobs that are simulated for each row, a core: long past the start.
JOBS_EACH = 96
CORES = 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024


class Queue:
    """Servers with one queue: first come, first served."""

    def __init__(self, servers):
        self.free = [0.0] * servers
        self.busy = 0.0

    def serve(self, at, takes):
        """When what comes at `at` and takes so long is done."""
        done = max(at, heapq.heappop(self.free)) + takes
        heapq.heappush(self.free, done)
        self.busy += takes
        return done

    def load(self, span):
        return self.busy / span / len(self.free)


def simulate(cores, given, chance):
    """Jobs a second, and the load of each part."""
    database, line, measuring = Queue(given.database_cores), Queue(1), 0.0
    request_s = given.scan_mb / given.store_mb_s, given.result_mb / given.store_mb_s
    jobs, ended, last = cores * JOBS_EACH, 0, 0.0
    # Workers come one after the other, as machines start.
    events = [(chance.uniform(0, given.measure_s), worker, iter(())) for worker in range(cores)]
    heapq.heapify(events)

    def steps():
        yield database, given.claim_ms / 1e3
        for _ in range(CLAIM):
            yield database, given.job_ms / 2e3
            yield line, request_s[0]
            yield None, given.measure_s * chance.lognormvariate(0, given.measure_spread)
            yield line, request_s[1]
            yield database, given.job_ms / 2e3
            yield "done", 0.0

    while ended < jobs:
        at, worker, way = heapq.heappop(events)
        step = next(way, None)
        if step is None:
            way = steps()
            step = next(way)
        place, takes = step
        if place == "done":
            ended, last, done = ended + 1, at, at
        elif place is None:
            measuring, done = measuring + takes, at + takes
        else:
            done = place.serve(at, takes) + given.latency_ms / 1e3
        heapq.heappush(events, (done, worker, way))
    loads = {"cores": measuring / last / cores, "database": database.load(last), "network": line.load(last)}
    return ended / last, loads


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, default, what in (
        ("measure-s", 0.19, "CPU seconds of a measurement (measured: gaiter extract, one thread)"),
        ("measure-spread", 0.15, "its spread: sigma of its logarithm (assumed)"),
        ("scan-mb", 0.84, "a crop as it is stored, MB (measured: three bodies of fixtures)"),
        ("result-mb", 0.2, "a result as it is stored, MB (measured: the same)"),
        ("store-mb-s", 1250.0, "what the store gives, MB/s (assumed: a line of 10 Gbit/s)"),
        ("latency-ms", 1.0, "there and back, ms (assumed: one house)"),
        ("claim-ms", 2.0, "core time of a claim of 16, ms (measured: claims.py on two cores)"),
        ("job-ms", 1.7, "core time of beginning and ending a job, ms (measured: claims.py on two cores)"),
    ):
        parser.add_argument(f"--{name}", type=float, default=default, help=f"{what}; {default}")
    parser.add_argument("--database-cores", type=int, default=2, help="cores of PostgreSQL; 2")
    given = parser.parse_args()
    print(f"{SCANS} scans; " + ", ".join(f"{name} {value:g}" for name, value in vars(given).items()))
    print("  cores   jobs/s    hours  efficiency   load of: cores  database  network   wall")
    one = None
    for cores in CORES:
        rate, loads = simulate(cores, given, random.Random(cores))
        one = one or rate
        wall = max(loads, key=loads.get)
        print(f"{cores:7} {rate:8.1f} {SCANS / rate / 3600:8.1f} {rate / one / cores:10.0%} {loads['cores']:17.0%}"
              f" {loads['database']:9.0%} {loads['network']:8.0%}   {wall}", flush=True)


if __name__ == "__main__":
    main()
