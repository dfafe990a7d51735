//! The index and the jobs in PostgreSQL. Every statement is a transaction of its own, and may come twice.

use std::io;
use std::time::Duration;

use gaiter_flow::disposition::Disposition;
use gaiter_https::{secret, tls};
use gaiter_record::ScanId;
use gaiter_record::archive::{Announcement, Heartbeat, MethodId, ScanResult, Withdrawal};
use postgres::config::SslMode;
use postgres::types::ToSql;
use postgres::{Client, Config, GenericClient, IsolationLevel, NoTls, Transaction};
use serde::de::DeserializeOwned;
use tokio_postgres_rustls::MakeRustlsConnect;

use crate::config::DatabasePlace;
use crate::fault::ArchiveFault;
use crate::figures::Figures;

/// The tables and views.
const SCHEMA: &str = include_str!("../schema.sql");

const SCHEMA_NUMBER: i32 = 1;

/// Whether there are tables.
const HAS_SCHEMA: &str = "select to_regclass('gaiter.version') is not null";

/// The lock under which the schema is applied; any number that no other program takes.
const SCHEMA_LOCK: i64 = 0x6761_6974_6572;

/// The longest way to a connection.
const CONNECT_MOST: Duration = Duration::from_secs(10);

/// A server that has gone without a word is noticed after so long.
const SILENT_MOST: Duration = Duration::from_secs(30);

/// How often a job is tried.
pub const ATTEMPTS_MOST: i16 = 5;

/// How long a claim holds. Longer than the longest step between two renewals: fetching, measuring, writing.
pub const LEASE: Duration = Duration::from_secs(300);

/// Scans of a heartbeat that could not be used, whether a person has decided on them or not.
const REFUSED: [Disposition; 2] = [Disposition::Refused, Disposition::Closed];

/// A claimed job.
#[derive(Debug, Clone)]
pub struct Claimed {
    pub scan: ScanId,
    /// The length of its PLY, bytes.
    pub bytes: u64,
    /// What the rest of the body has shown, as JSON.
    pub whole: String,
}

/// Opens a connection.
///
/// # Errors
/// If the database cannot be reached, or lets nobody in.
pub fn connect(place: &DatabasePlace) -> Result<Client, ArchiveFault> {
    let mut config = Config::new();
    config
        .host(&place.host)
        .port(place.port)
        .dbname(&place.name)
        .user(&place.user)
        .application_name("gaiter-archive")
        .options("-c search_path=gaiter")
        .connect_timeout(CONNECT_MOST)
        .keepalives_idle(SILENT_MOST)
        .tcp_user_timeout(SILENT_MOST);
    if let Some(password) = &place.password {
        config.password(secret::read(password)?);
    }
    if place.is_encrypted() {
        config.ssl_mode(SslMode::Require);
        let trusted = tls::trust(&place.tls)?;
        return Ok(config.connect(MakeRustlsConnect::new((*trusted).clone()))?);
    }
    config.ssl_mode(SslMode::Disable);
    Ok(config.connect(NoTls)?)
}

/// Checks that the tables are those of this version.
///
/// # Errors
/// If there are none, or others.
pub fn check_schema(client: &mut Client) -> Result<(), ArchiveFault> {
    let has_schema: bool = client.query_one(HAS_SCHEMA, &[])?.get(0);
    if !has_schema {
        return Err(ArchiveFault::NoSchema);
    }
    let found: i32 = client.query_one("select schema from version", &[])?.get(0);
    match found == SCHEMA_NUMBER {
        true => Ok(()),
        false => Err(ArchiveFault::OtherSchema { found, own: SCHEMA_NUMBER }),
    }
}

/// A transaction that reads the tables as they are at one moment.
///
/// # Errors
/// As [`check_schema`].
pub fn moment(client: &mut Client) -> Result<Transaction<'_>, ArchiveFault> {
    check_schema(client)?;
    let begun = client.build_transaction().isolation_level(IsolationLevel::RepeatableRead);
    Ok(begun.read_only(true).start()?)
}

/// Makes the tables where there are none.
///
/// # Errors
/// As [`check_schema`].
pub fn make_schema(client: &mut Client) -> Result<(), ArchiveFault> {
    let mut transaction = client.transaction()?;
    transaction.execute("select pg_advisory_xact_lock($1)", &[&SCHEMA_LOCK])?;
    let has_schema: bool = transaction.query_one(HAS_SCHEMA, &[])?.get(0);
    if !has_schema {
        transaction.batch_execute(SCHEMA)?;
    }
    transaction.commit()?;
    check_schema(client)
}

/// The rows that a statement gives, each by the names of its columns.
///
/// # Errors
/// Those of the database; of a row that lacks a column.
pub fn rows<T: DeserializeOwned>(
    client: &mut impl GenericClient,
    statement: &str,
    params: &[&(dyn ToSql + Sync)],
) -> Result<Vec<T>, ArchiveFault> {
    let all = format!("select coalesce(json_agg(answer), '[]')::text from ({statement}) answer");
    let all: String = client.query_one(all.as_str(), params)?.get(0);
    Ok(serde_json::from_str(&all).map_err(io::Error::from)?)
}

/// Enters a method. The first one is the current one.
///
/// # Errors
/// Those of the database.
pub fn enter_method(client: &mut Client, method: &MethodId) -> Result<(), ArchiveFault> {
    let statement = "insert into method (method, is_current) \
                     select $1, not exists (select from method where is_current) \
                     where not exists (select from method where method = $1) on conflict do nothing";
    client.execute(statement, &[&method.as_str()])?;
    Ok(())
}

/// What is done about a scan that is announced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Then {
    /// It is measured, if this method has no result for it.
    Measure,
    /// Nothing yet: its results are indexed first.
    Wait,
}

/// Enters what a station announced. What it said later takes the place of what it said earlier.
///
/// # Errors
/// Those of the database; of a figure that cannot be written as JSON.
pub fn enter_announcement(
    client: &mut Client,
    announced: &Announcement,
    method: &MethodId,
    then: Then,
) -> Result<(), ArchiveFault> {
    let whole = serde_json::to_string(&announced.whole)?;
    let statement = "\
        with of_scan as (
            insert into scan (scan, bytes, whole, first_seen)
            values (decode($1, 'hex'), $2, $3::text::json, $4::text::timestamptz) on conflict do nothing),
        of_station as (
            insert into announcement (station, scan, revision, export, method, first_seen, patient, said)
            values ($5, decode($1, 'hex'), $6, decode($7, 'hex'), $8, $4::text::timestamptz, decode($9, 'hex'),
                $12::text::timestamptz)
            on conflict (scan, station) do update set (revision, export, method, first_seen, patient, said)
            = (excluded.revision, excluded.export, excluded.method, excluded.first_seen, excluded.patient, excluded.said)
            where (announcement.said, announcement.revision) < (excluded.said, excluded.revision))
        insert into job (scan, method)
        select decode($1, 'hex'), $10 where $11
            and not exists (select from result where scan = decode($1, 'hex') and method = $10)
        on conflict do nothing";
    client.execute(
        statement,
        &[
            &announced.scan.as_str(),
            &announced.bytes.cast_signed(),
            &whole,
            &announced.first_seen.to_string(),
            &announced.station.as_str(),
            &announced.revision.cast_signed(),
            &announced.export.as_str(),
            &announced.method.as_str(),
            &announced.patient.as_ref().map(|patient| patient.as_str()),
            &method.as_str(),
            &(then == Then::Measure),
            &announced.at.to_string(),
        ],
    )?;
    Ok(())
}

/// Enters what a station has taken back. It does not matter whether that is indexed already.
///
/// # Errors
/// Those of the database.
pub fn enter_withdrawal(client: &mut Client, withdrawn: &Withdrawal) -> Result<(), ArchiveFault> {
    let Withdrawal { station, export, patient, at, .. } = withdrawn;
    let statement = "\
        insert into withdrawal (station, export, patient, said)
        values ($1, decode($2, 'hex'), decode($3, 'hex'), $4::text::timestamptz) on conflict do nothing";
    let patient = patient.as_ref().map(|patient| patient.as_str());
    client.execute(statement, &[&station.as_str(), &export.as_str(), &patient, &at.to_string()])?;
    Ok(())
}

/// Makes a job of each scan that no method has a result for, and removes those of other methods, which no worker of
/// this version does.
///
/// # Errors
/// Those of the database.
pub fn enter_missing_jobs(client: &mut Client, method: &MethodId) -> Result<u64, ArchiveFault> {
    let statement = "\
        with others as (delete from job where method <> $1)
        insert into job (scan, method)
        select scan, $1 from scan s
        where not exists (select from result r where r.scan = s.scan)
        on conflict do nothing";
    Ok(client.execute(statement, &[&method.as_str()])?)
}

/// Enters a heartbeat.
///
/// # Errors
/// Those of the database; of a figure that cannot be written as JSON.
pub fn enter_heartbeat(client: &mut Client, beat: &Heartbeat) -> Result<(), ArchiveFault> {
    let statement = "\
        with of_station as (
            insert into station
            values ($1, $2::text::timestamptz, $3, $4, $5::text::timestamptz, $6::float8, $7::text::jsonb)
            on conflict (station) do update set (heard, gaiter, is_ready, oldest_undelivered, phantom_bias_mm, scans)
            = (excluded.heard, excluded.gaiter, excluded.is_ready, excluded.oldest_undelivered,
               excluded.phantom_bias_mm, excluded.scans))
        insert into station_day (station, day, scans, refused, phantom_bias_mm)
        values ($1, ($2::text::timestamptz at time zone 'UTC')::date, $8, $9, $6::float8)
        on conflict (station, day) do update set (scans, refused, phantom_bias_mm)
        = (excluded.scans, excluded.refused, excluded.phantom_bias_mm)";
    let total = |sum: u64, count: &u64| sum.saturating_add(*count);
    let scans = beat.scans.values().fold(0, total);
    let refused = REFUSED.iter().filter_map(|is| beat.scans.get(is.word())).fold(0, total);
    client.execute(
        statement,
        &[
            &beat.station.as_str(),
            &beat.at.to_string(),
            &beat.gaiter,
            &beat.is_ready,
            &beat.oldest_undelivered.map(|at| at.to_string()),
            &beat.phantom_bias_mm,
            &serde_json::to_string(&beat.scans)?,
            &scans.cast_signed(),
            &refused.cast_signed(),
        ],
    )?;
    Ok(())
}

/// Enters a result, and ends its job, at once. A scan that was removed meanwhile gets none.
///
/// # Errors
/// Those of the database.
pub fn enter_result(client: &mut Client, result: &ScanResult) -> Result<(), ArchiveFault> {
    let of = Figures::of(result);
    let statement = "\
        with done as (delete from job where scan = decode($1, 'hex') and method = $2)
        insert into result
            (scan, method, outcome, stature_mm, crotch_height_mm, findings, height_mm, girth_mm, girth_sd_mm)
        select scan, $2, $3, $4::float8, $5::float8, $6::text[], $7::float8[], $8::float8[], $9::float8[]
        from scan where scan = decode($1, 'hex')
        on conflict do nothing";
    client.execute(
        statement,
        &[
            &result.scan.as_str(),
            &result.method.as_str(),
            &of.outcome,
            &of.stature_mm,
            &of.crotch_height_mm,
            &of.findings,
            &of.height_mm,
            &of.girth_mm,
            &of.girth_sd_mm,
        ],
    )?;
    Ok(())
}

/// Claims up to `most` jobs. The newest come first: a scan of today does not wait behind millions of old ones.
///
/// # Errors
/// Those of the database.
pub fn claim(
    client: &mut Client,
    worker: &str,
    method: &MethodId,
    most: i64,
) -> Result<Vec<Claimed>, ArchiveFault> {
    let statement = "\
        with claimed as (
            update job set worker = $1, due = now() + make_interval(secs => $2)
            where (scan, method) in (
                select scan, method from job where method = $3 and due <= now() and attempts < $4
                order by due desc limit $5 for update skip locked)
            returning scan)
        select encode(scan, 'hex'), bytes, whole::text from claimed join scan using (scan)";
    let params: [&(dyn ToSql + Sync); 5] =
        [&worker, &LEASE.as_secs_f64(), &method.as_str(), &ATTEMPTS_MOST, &most];
    let rows = client.query(statement, &params)?;
    let claimed = rows.into_iter().filter_map(|row| {
        let (scan, bytes): (String, i64) = (row.get(0), row.get(1));
        // 32 bytes as hexadecimal digits are always one.
        let scan = ScanId::parse(&scan)?;
        Some(Claimed { scan, bytes: bytes.cast_unsigned(), whole: row.get(2) })
    });
    Ok(claimed.collect())
}

/// Begins to measure the first of these claimed scans: counts the attempt, and renews the lease of all. Returns
/// whether the first is still claimed.
///
/// # Errors
/// Those of the database.
pub fn begin(
    client: &mut Client,
    worker: &str,
    method: &MethodId,
    scans: &[&str],
) -> Result<bool, ArchiveFault> {
    let statement = "\
        update job set due = now() + make_interval(secs => $1),
            attempts = attempts + (scan = decode($5, 'hex'))::int
        where method = $2 and worker = $3 and scan in (select decode(hex, 'hex') from unnest($4::text[]) hex)
        returning scan = decode($5, 'hex')";
    let Some(first) = scans.first() else { return Ok(false) };
    let params: [&(dyn ToSql + Sync); 5] =
        [&LEASE.as_secs_f64(), &method.as_str(), &worker, &scans, first];
    let rows = client.query(statement, &params)?;
    Ok(rows.iter().any(|row| row.get(0)))
}

/// Notes why a job was not done. It comes again after a while that grows; after the last attempt it is a dead letter
/// at once.
///
/// # Errors
/// Those of the database.
pub fn put_off(
    client: &mut Client,
    worker: &str,
    method: &MethodId,
    scan: &str,
    reason: &str,
) -> Result<(), ArchiveFault> {
    let statement = "\
        update job set reason = $4,
            due = now() + case when attempts < $5 then make_interval(secs => 5 * 2 ^ attempts) else interval '0' end
        where method = $1 and worker = $2 and scan = decode($3, 'hex')";
    client.execute(statement, &[&method.as_str(), &worker, &scan, &reason, &ATTEMPTS_MOST])?;
    Ok(())
}

/// Gives claimed jobs back, because machine or servers are at fault: the attempt at the first does not count.
///
/// # Errors
/// Those of the database.
pub fn give_back(
    client: &mut Client,
    worker: &str,
    method: &MethodId,
    scans: &[&str],
) -> Result<(), ArchiveFault> {
    let statement = "\
        update job set due = now(), attempts = greatest(0, attempts - (scan = decode($4, 'hex'))::int)
        where method = $1 and worker = $2 and scan in (select decode(hex, 'hex') from unnest($3::text[]) hex)";
    let Some(first) = scans.first() else { return Ok(()) };
    client.execute(statement, &[&method.as_str(), &worker, &scans, first])?;
    Ok(())
}

/// How many jobs of a method are not done, without dead letters.
///
/// # Errors
/// Those of the database.
pub fn open_jobs(client: &mut Client, method: &MethodId) -> Result<i64, ArchiveFault> {
    let statement = "select count(*) from job where method = $1 and (attempts < $2 or due > now())";
    Ok(client.query_one(statement, &[&method.as_str(), &ATTEMPTS_MOST])?.get(0))
}
