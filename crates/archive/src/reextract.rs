//! Measures all scans by the method of this version: a sample first, a table of what would change, a limit that stops,
//! and a person's go. Older results stay, and nothing goes back into a patient's record.

use std::fmt::Write;
use std::process::ExitCode;

use gaiter_leg::Method;
use gaiter_record::archive::MethodId;
use postgres::Client;
use serde::Deserialize;

use crate::config::ArchiveConfig;
use crate::fault::ArchiveFault;
use crate::{database, print};

/// The sample moved further than the limit.
const EXIT_OVER_LIMIT: u8 = 65;

/// The share of scans of the sample that may be refused again.
const REFUSED_SHARE: f64 = 0.001;

/// What a person chose.
#[derive(Debug, clap::Args)]
pub struct Choice {
    /// How many scans are the sample.
    #[arg(long, default_value_t = 200)]
    pub sample: u32,
    /// How far girths of B, C or D may move on average before a person must agree, mm.
    #[arg(long, default_value_t = 0.5)]
    pub limit_mm: f64,
    /// Measure all others, and take the method as the current one when all are measured.
    #[arg(long)]
    pub go: bool,
    /// With --go: also if the sample moved further than the limit.
    #[arg(long, requires = "go")]
    pub over_limit: bool,
}

/// What changes at a level of a leg.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Change {
    side: String,
    level: String,
    both: i64,
    came: i64,
    went: i64,
    mean_mm: f64,
    largest_mm: f64,
    largest_scan: String,
}

/// Begins or continues with measuring again, and says how far it is.
///
/// # Errors
/// Those of the database.
pub fn reextract(config: &ArchiveConfig, choice: &Choice) -> Result<ExitCode, ArchiveFault> {
    let method = MethodId::of(&Method::default())?;
    let mut client = database::connect(&config.database)?;
    database::check_schema(&mut client)?;
    database::enter_method(&mut client, &method)?;
    let current: String =
        client.query_one("select method from method where is_current", &[])?.get(0);
    if current == method.as_str() {
        print(format_args!("{method} is the current method"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let measured = compared(&mut client, &current, &method)?;
    let wanted = i64::from(choice.sample) - measured;
    let left = database::open_jobs(&mut client, &method)?;
    if left == 0 && wanted > 0 && enter_jobs(&mut client, &method, Some(wanted))? > 0 {
        print(format_args!("the sample is to be measured: {wanted} scans; then call this again"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let (table, is_over) = judged(&mut client, &current, &method, measured, choice.limit_mm)?;
    print(table)?;
    if left > 0 {
        print(format_args!("{left} scans are still to be measured"))?;
    } else if choice.go && (!is_over || choice.over_limit) {
        go(&mut client, &method)?;
    } else if is_over {
        print("this is over the limit: --go --over-limit measures all others in spite of it")?;
    } else {
        print("--go measures all others")?;
    }
    Ok(if is_over { ExitCode::from(EXIT_OVER_LIMIT) } else { ExitCode::SUCCESS })
}

/// Makes jobs of all that is left; if nothing is, the method becomes the current one.
fn go(client: &mut Client, method: &MethodId) -> Result<(), ArchiveFault> {
    let left = enter_jobs(client, method, None)?;
    if left > 0 {
        print(format_args!("{left} scans are to be measured; then call this again"))?;
        return Ok(());
    }
    let mut transaction = client.transaction()?;
    transaction.execute("update method set is_current = false where is_current", &[])?;
    let statement = "update method set is_current = true where method = $1";
    transaction.execute(statement, &[&method.as_str()])?;
    transaction.commit()?;
    print(format_args!("all scans are measured; {method} is the current method now"))?;
    Ok(())
}

/// Makes jobs of scans that have no result of a method. Hashes are spread evenly, so the first are as good as any.
fn enter_jobs(
    client: &mut Client,
    method: &MethodId,
    most: Option<i64>,
) -> Result<u64, ArchiveFault> {
    // Due long ago: today's scans go before them.
    let statement = "\
        insert into job (scan, method, due)
        select scan, $1, now() - interval '1 year' from scan s
        where not exists (select from result r where r.scan = s.scan and r.method = $1)
            and not exists (select from job j where j.scan = s.scan and j.method = $1)
        order by scan limit $2 on conflict do nothing";
    Ok(client.execute(statement, &[&method.as_str(), &most])?)
}

/// How many scans both methods have a result for.
fn compared(client: &mut Client, old: &str, new: &MethodId) -> Result<i64, ArchiveFault> {
    let statement = "select count(*) from result o join result n using (scan) \
                     where o.method = $1 and n.method = $2";
    Ok(client.query_one(statement, &[&old, &new.as_str()])?.get(0))
}

/// The table of what changes, and whether that is over the limit.
fn judged(
    client: &mut Client,
    old: &str,
    new: &MethodId,
    measured: i64,
    limit_mm: f64,
) -> Result<(String, bool), ArchiveFault> {
    let changes = changes(client, old, new)?;
    let statement = "\
        select count(*) from result o join result n using (scan)
        where o.method = $1 and n.method = $2 and o.outcome = 'measured' and n.outcome <> 'measured'";
    let refused: i64 = client.query_one(statement, &[&old, &new.as_str()])?.get(0);
    let refused_share = refused as f64 / measured.max(1) as f64;
    let moved = |of: &Change| ["B", "C", "D"].contains(&&*of.level) && of.mean_mm > limit_mm;
    let is_over = refused_share > REFUSED_SHARE || changes.iter().any(moved);
    let mut table = format!("{measured} scans by {old} and {new}; {refused} are refused anew\n");
    for of in &changes {
        let Change { side, level, both, came, went, mean_mm, largest_mm, largest_scan } = of;
        // Writing to a text cannot fail.
        let _ = writeln!(
            table,
            "{side:5} {level:2} mean {mean_mm:6.3} mm, largest {largest_mm:6.2} mm ({:.8}), on {both}; \
             {came} came, {went} went",
            largest_scan
        );
    }
    table.truncate(table.trim_end().len());
    Ok((table, is_over))
}

fn changes(client: &mut Client, old: &str, new: &MethodId) -> Result<Vec<Change>, ArchiveFault> {
    let statement = "\
        with both_have as (
            select scan from result where method = $1 and outcome = 'measured'
            intersect select scan from result where method = $2 and outcome = 'measured'),
        o as (select * from level where method = $1 and scan in (select scan from both_have)),
        n as (select * from level where method = $2 and scan in (select scan from both_have)),
        c as (select coalesce(o.side, n.side) side, coalesce(o.level, n.level) level, coalesce(o.scan, n.scan) scan,
                o.girth_mm is null came, n.girth_mm is null went, abs(n.girth_mm - o.girth_mm)::float8 moved
            from o full join n on (o.scan, o.side, o.level) = (n.scan, n.side, n.level))
        select side, level, count(moved) as both, count(*) filter (where came) as came,
            count(*) filter (where went) as went,
            coalesce(avg(moved), 0) as mean_mm, coalesce(max(moved), 0) as largest_mm,
            coalesce(encode((array_agg(scan order by moved desc nulls last))[1], 'hex'), '') as largest_scan
        from c group by side, level order by side, level";
    database::rows(client, statement, &[&old, &new.as_str()])
}
