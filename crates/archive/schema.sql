-- The index of an archive, schema 1. `gaiter-archive index` applies it where it is absent. All of it can be made
-- again from the objects: `gaiter-archive index --reconcile`.

create schema gaiter;
set local search_path = gaiter;

create table version (schema integer not null);
insert into version values (1);

-- A crop, by the SHA-256 of its PLY. `whole` is what the rest of the body has shown, as it was sent: json
-- keeps it letter by letter.
create table scan (
    scan bytea primary key check (octet_length(scan) = 32),
    bytes bigint not null,
    whole json not null,
    first_seen timestamptz not null
);

-- The latest announcement of each station: stations see to it that what they say later has a later `said`. The patient
-- may be unknown, and may change with a later announcement. Earlier ones are in the bucket.
create table announcement (
    scan bytea not null references scan on delete cascade,
    station text not null,
    revision integer not null,
    export bytea not null check (octet_length(export) = 32),
    method text not null,
    first_seen timestamptz not null,
    patient bytea check (octet_length(patient) = 32),
    said timestamptz not null,
    primary key (scan, station)
);
-- Visits of one person are found in it alone, in their order, with all that says whether they were taken back.
create index announcement_patient on announcement (patient, station, first_seen) include (scan, export, said);

-- What stations have taken back: what they said earlier of this export and this patient does not count.
create table withdrawal (
    station text not null,
    export bytea not null check (octet_length(export) = 32),
    patient bytea check (octet_length(patient) = 32),
    said timestamptz not null,
    primary key (station, export, said)
);

-- Methods by the order in which the archive met them. A person moves `is_current`. `layout` is that of the arrays of
-- their results.
create table method (
    method text primary key,
    number integer generated always as identity,
    is_current boolean not null default false,
    layout smallint not null default 1
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

-- Where the figures of a leg's level stand in the arrays of `result`. There is one layout; by it the few places that are
-- asked for are joined to the method, and only then to a million results, by several processes.
create table place (
    layout smallint not null,
    number smallint not null,
    side text not null,
    level text not null,
    primary key (layout, number),
    unique (layout, side, level)
);
insert into place
select 1, row_number() over (order by side_order, level_order), side, level
from unnest(array['left', 'right']) with ordinality sides(side, side_order),
    unnest(array['A', 'Y', 'B', 'B1', 'C', 'D', 'E', 'F', 'G']) with ordinality levels(level, level_order);

-- What a method says of a scan: a row for an object `result/…`. The whole record is there. `outcome` is `measured`
-- or the code of a refusal. The arrays have a figure for each `place`, null where the level is not found: an archive
-- of millions is asked for one level of all, and must not read all levels of all as text.
create table result (
    scan bytea not null references scan on delete cascade,
    method text not null references method,
    outcome text not null,
    stature_mm real,
    crotch_height_mm real,
    findings text[] not null,
    height_mm real[] not null,
    girth_mm real[] not null,
    girth_sd_mm real[] not null,
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

-- The last heartbeat of each station on each day (UTC): how many scans are in its journal, and how many of them could
-- not be used. Heartbeats are overwritten, so this alone cannot be made again; it begins anew.
create table station_day (
    station text not null references station on delete cascade,
    day date not null,
    scans bigint not null,
    refused bigint not null,
    phantom_bias_mm real,
    primary key (station, day)
);

-- For questions: the views of docs/archive.md. Only these are for the role that reads.

-- Every result. A scan that is measured anew has several. The current method has a result of each scan, but of those
-- that came in since a newer version measures.
create view scan_result as
select r.scan, r.method, m.is_current, r.outcome, r.stature_mm, r.crotch_height_mm, r.findings
from result r join method m using (method);

-- Every level that was found, of every result.
create view level as
select r.scan, r.method, m.is_current, r.stature_mm, p.side, p.level,
    r.height_mm[p.number] as height_mm, r.girth_mm[p.number] as girth_mm, r.girth_sd_mm[p.number] as girth_sd_mm
from result r join method m using (method) join place p using (layout)
where r.girth_mm[p.number] is not null;

-- Which station sent which scan when, and of whom, unless it was taken back.
create view visit as
select station, scan, first_seen, patient
from announcement a
where not exists (select from withdrawal w where w.station = a.station and w.export = a.export
    and w.patient is not distinct from a.patient and w.said > a.said);

-- Every level of every visit by every method; of a scan without levels, such as a refused one, one row without a level.
-- This is what is exported.
create view visit_level as
select v.station, v.scan, v.first_seen, v.patient, r.method, m.is_current, r.outcome, r.stature_mm, r.crotch_height_mm,
    p.side, p.level, r.height_mm[p.number] as height_mm, r.girth_mm[p.number] as girth_mm,
    r.girth_sd_mm[p.number] as girth_sd_mm
from visit v join result r using (scan) join method m using (method)
left join place p on p.layout = m.layout and r.girth_mm[p.number] is not null;

-- Scans that could not be measured.
create view dead_letter as
select scan, method, attempts, coalesce(reason, 'its worker ended each time') as reason
from job
where attempts >= 5 and due <= now();

-- Each day of each station: how many scans came on this day alone, and how many of them could not be used. Null on the
-- first day, and on one on which the journal shrank.
create view station_history as
select station, day,
    case when scans >= before and refused >= refused_before then scans - before end as scans,
    case when scans >= before and refused >= refused_before then refused - refused_before end as refused,
    phantom_bias_mm
from (
    select *, lag(scans) over days as before, lag(refused) over days as refused_before
    from station_day window days as (partition by station order by day)) counted;

-- How each station is: its last heartbeat; scans and refusals of today; its share of refusals, and its mean bias of the
-- phantom, on the 30 days before; how many scans of it are here.
create view station_status as
with archived as (select station, count(*) as archived from visit group by station)
select station, s.heard, s.gaiter, s.is_ready, s.oldest_undelivered, of_days.scans_today, of_days.refused_today,
    of_days.refused_share, s.phantom_bias_mm, s.phantom_bias_mm - of_days.mean_bias_mm as phantom_drift_mm,
    coalesce(a.archived, 0) as archived
from station s full join archived a using (station)
left join lateral (
    select sum(h.scans) filter (where h.day = now.day)::bigint as scans_today,
        sum(h.refused) filter (where h.day = now.day)::bigint as refused_today,
        sum(h.refused) filter (where h.day < now.day)::float8
            / nullif(sum(h.scans) filter (where h.day < now.day), 0) as refused_share,
        avg(h.phantom_bias_mm) filter (where h.day < now.day) as mean_bias_mm
    from station_history h, (select (now() at time zone 'UTC')::date as day) now
    where h.station = s.station and h.day between now.day - 30 and now.day) of_days on true;

-- The role that reads, where there is one.
do $$
begin
    if exists (select from pg_roles where rolname = 'gaiter_reader') then
        grant usage on schema gaiter to gaiter_reader;
        grant select on version, scan_result, level, visit, visit_level, dead_letter, station_history, station_status
            to gaiter_reader;
    end if;
end
$$;
