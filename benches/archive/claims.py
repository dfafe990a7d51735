"""Claims per second of the archive's database.

    python3 benches/archive/claims.py [SCANS]

It starts a PostgreSQL of its own with the settings that Debian gives, on two cores, fills it with SCANS scans (one
million) with a job each, and runs the statements of `gaiter-archive work` with pgbench. It ends with 1 where the
limit is missed.
"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

# What must hold.
CLAIMS_LEAST = 5000
# As `work` has it.
CLAIM = 16
CLIENTS = 8
# So many claims at most, and never more than there are jobs.
CLAIMS_MOST = 20_000

HERE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = max(pathlib.Path("/usr/lib/postgresql").glob("*/bin"))
ROLE = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"] if os.getuid() == 0 else []
METHOD = "0.1.0+1a2b3c4d"

# Figures of the nine places of each leg, as a scan has them.
FIGURES = "array_fill(345.6::float8, array[18])"

# Scans of 2000 people at 200 stations within two years.
FILL = f"""
insert into method (method, is_current) values ('{METHOD}', true);
insert into scan select sha256(n::text::bytea), 3000000, '{{"stature_mm": 1700.0, "unit": "mm"}}', now() - n * interval '1 minute'
    from generate_series(1, :scans) n;
insert into announcement select sha256(n::text::bytea), 'station-' || n % 200, 1, sha256((-n)::text::bytea), '{METHOD}',
    now() - n * interval '1 minute', sha256((n % 2000)::text::bytea), now() - n * interval '1 minute'
    from generate_series(1, :scans) n;
insert into job (scan, method) select scan, '{METHOD}' from scan;
vacuum analyze;
"""


def statement(function, *values):
    """The statement of a function of database.rs, with values for $1, $2, ... as pgbench writes them."""
    source = (HERE / "crates/archive/src/database.rs").read_text()
    pattern = r"pub fn " + function + r'\(.*?let statement = "\\\n(.*?)";'
    text = re.search(pattern, source, re.DOTALL).group(1)
    text = re.sub(r"\$(\d+)", lambda found: values[int(found.group(1)) - 1], text)
    return re.sub(r"\s+", " ", text) + ";\n"


def main():
    scans = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    with tempfile.TemporaryDirectory() as folder:
        if ROLE:
            subprocess.run(["chown", "postgres", folder], check=True)
        data = f"{folder}/data"
        quiet = {"check": True, "stdout": subprocess.DEVNULL}
        subprocess.run([*ROLE, f"{PROGRAMS}/initdb", "-D", data, "-A", "trust", "-U", "postgres"], **quiet)
        sockets = ["-c", "listen_addresses=", "-c", f"unix_socket_directories={folder}"]
        cores = ["taskset", "-c", "0,1"]
        server = subprocess.Popen([*cores, *ROLE, f"{PROGRAMS}/postgres", "-D", data, *sockets],
                                  stderr=subprocess.DEVNULL)
        asked = ["-h", folder, "-U", "postgres"]
        env = {**os.environ, "PGOPTIONS": "-c search_path=gaiter"}

        def sql(text, **more):
            return subprocess.run([f"{PROGRAMS}/psql", *asked, "-qAt", "-v", "ON_ERROR_STOP=1", "-v", f"scans={scans}"],
                                  input=text, text=True, check=True, env=env, **more)

        try:
            while subprocess.run([f"{PROGRAMS}/pg_isready", *asked], stdout=subprocess.DEVNULL).returncode:
                time.sleep(0.1)
            schema = (HERE / "crates/archive/schema.sql").read_text()
            sql(f"begin;\n{schema}\ncommit;")
            began = time.monotonic()
            sql(FILL)
            print(f"{scans} scans, jobs in {time.monotonic() - began:.0f} s", flush=True)
            missed = not claims(folder, asked, env, sql, scans)
            jobs(folder, asked, env, sql, scans)
        finally:
            server.send_signal(signal.SIGINT)
            server.wait()
    return int(missed)


def pgbench(folder, asked, env, script, each):
    """Runs a script `each` times by each client; returns the seconds of all and what is said of one."""
    path = pathlib.Path(folder, "script.sql")
    path.write_text(script)
    path.chmod(0o644)
    said = subprocess.run(
        [f"{PROGRAMS}/pgbench", *asked, "-n", "-M", "prepared", "-c", str(CLIENTS), "-j", "2", "-t", str(each), "-f",
         str(path), "postgres"], check=True, env=env, capture_output=True, text=True).stdout
    took = each * CLIENTS / float(re.search(r"tps = ([\d.]+)", said).group(1))
    return took, re.search(r"latency average = (.*)", said).group(1)


def claims(folder, asked, env, sql, scans):
    """Runs the claim, until no more than there are have been made; prints how many jobs a second were claimed."""
    each = min(CLAIMS_MOST, scans // CLAIM) // CLIENTS
    worker = "'worker-' || :client_id"
    script = statement("claim", worker, "300", f"'{METHOD}'", "5", str(CLAIM))
    took, latency = pgbench(folder, asked, env, script, each)
    claimed = int(sql("select count(*) from job where worker is not null", stdout=subprocess.PIPE).stdout)
    print(f"{claimed / took:8.0f} claims a second (at least {CLAIMS_LEAST}): {claimed} by {CLIENTS} workers, {CLAIM} at"
          f" a time, {latency} each", flush=True)
    return claimed >= CLAIMS_LEAST * took


def jobs(folder, asked, env, sql, scans):
    """Begins and ends jobs as a worker does that measures in no time; prints how many a second."""
    sql("update job set worker = 'w'; vacuum analyze job;")
    scan = "encode(sha256(:n::text::bytea), 'hex')"
    script = f"\\set n random(1, {scans})\n" + statement("begin", "300", f"'{METHOD}'", "'w'", f"array[{scan}]", scan)
    figures = ["1700", "800", "'{}'", FIGURES, FIGURES, FIGURES]
    script += statement("enter_result", scan, f"'{METHOD}'", "'measured'", *figures)
    each = min(CLAIMS_MOST, scans // 4) // CLIENTS
    took, _ = pgbench(folder, asked, env, script, each)
    print(f"{each * CLIENTS / took:8.0f} jobs begun and ended a second, one by one by {CLIENTS} workers", flush=True)


if __name__ == "__main__":
    sys.exit(main())
