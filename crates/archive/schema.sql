-- The index of an archive, schema 1. `gaiter-archive index` applies it where it is absent. All of it can be made
-- again from the objects: `gaiter-archive index --reconcile`.

create schema gaiter;
set local search_path = gaiter;

create table version (schema integer not null);
insert into version values (1);

-- A crop, by the SHA-256 of its PLY. `whole` is what the rest of the body told, as it was sent: json keeps it
-- letter by letter. It is null for a phantom, which is not measured anew.
create table scan (
    scan bytea primary key check (octet_length(scan) = 32),
    bytes bigint not null,
    whole json,
    first_seen timestamptz not null
);

-- What stations said of it, and when by their clocks. Nobody's scan has no patient. The same may be there several times.
create table announcement (
    station text not null,
    scan bytea not null references scan on delete cascade,
    revision integer not null,
    export bytea not null check (octet_length(export) = 32),
    method text not null,
    first_seen timestamptz not null,
    patient bytea check (octet_length(patient) = 32),
    said timestamptz not null,
    primary key (station, scan, revision, said)
);
create index announcement_scan on announcement (scan);
create index announcement_patient on announcement (patient) where patient is not null;

-- What stations have taken back: what they said earlier of this export and this patient does not count.
create table withdrawal (
    station text not null,
    export bytea not null check (octet_length(export) = 32),
    patient bytea check (octet_length(patient) = 32),
    said timestamptz not null,
    primary key (station, export, said)
);

-- Methods by the order in which the archive met them. A person moves `is_current`.
create table method (
    method text primary key,
    number integer generated always as identity,
    is_current boolean not null default false
);
create unique index method_current on method (is_current) where is_current;

-- Scans that are to be measured. A claim is a lease: it moves `due` into the future. One whose lease ran out after
-- the last attempt is a dead letter. Claims rewrite rows, so they get room to do so in place.
create table job (
    scan bytea not null references scan on delete cascade,
    method text not null references method,
    due timestamptz not null default now(),
    attempts smallint not null default 0,
    worker text,
    reason text,
    primary key (scan, method)
) with (fillfactor = 70, autovacuum_vacuum_scale_factor = 0.02);
create index job_due on job (method, due);

-- What a method says of a scan: a row for an object `result/…`. The whole record is there. `outcome` is `measured`
-- or the code of a refusal; `levels` has the figures of each level found, by leg.
create table result (
    scan bytea not null references scan on delete cascade,
    method text not null references method,
    outcome text not null,
    stature_mm real,
    crotch_height_mm real,
    findings text[] not null,
    levels jsonb not null,
    written timestamptz not null default now(),
    primary key (scan, method)
);
create index result_method on result (method);

-- The last heartbeat of each station.
create table station (
    station text primary key,
    heard timestamptz not null,
    gaiter text not null,
    is_ready boolean not null,
    oldest_undelivered timestamptz,
    phantom_bias_mm real,
    scans jsonb not null
);

-- For questions: the views of docs/archive.md. Only these are for the role that reads.

-- The result of each scan by the current method, else by the newest that has one.
create view scan_result as
select distinct on (r.scan)
    encode(r.scan, 'hex') as scan, r.method, r.outcome, r.stature_mm, r.crotch_height_mm, r.findings, s.first_seen
from result r join method m using (method) join scan s using (scan)
order by r.scan, m.is_current desc, m.number desc;

-- Every level of every result.
create view level as
select encode(r.scan, 'hex') as scan, r.method, leg.key as side, level.key as level,
    (level.value ->> 'height_mm')::real as height_mm,
    (level.value ->> 'girth_mm')::real as girth_mm,
    (level.value ->> 'girth_sd_mm')::real as girth_sd_mm
from result r, jsonb_each(r.levels) leg, jsonb_each(leg.value) level;

-- Which station sent which scan when, of whom: the newest revision of each, unless it was taken back.
create view visit as
select distinct on (a.station, a.scan, a.patient)
    a.station, encode(a.scan, 'hex') as scan, a.revision, a.first_seen, encode(a.patient, 'hex') as patient
from announcement a
where not exists (select from withdrawal w where w.station = a.station and w.export = a.export
    and w.patient is not distinct from a.patient and w.said > a.said)
order by a.station, a.scan, a.patient, a.revision desc;

-- Scans that could not be measured.
create view dead_letter as
select encode(scan, 'hex') as scan, method, attempts, coalesce(reason, 'its worker ended each time') as reason
from job
where attempts >= 5 and due <= now();
