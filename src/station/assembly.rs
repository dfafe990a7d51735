//! Puts a station together at each start and reload.

use std::sync::Arc;

use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::facts::IntakeState;
use gaiter_flow::{Facts, Identity};
use jiff::Timestamp;
use tracing::{error, info};

use super::board::Board;
use super::booth::Booth;
use super::core::{Core, journal_file};
use super::custody::phantom_series::PhantomSeries;
use super::custody::{Custody, CustodyFault};
use super::delivery::measuring;
use super::delivery::preview::Previews;
use super::error::StationError;
use super::event::Observer;
use super::intake::phantom;
use super::journal::JournalError;
use super::operator::page::desk::Desk;
use super::persons::erase;
use super::rebuild;
use super::stores::Stores;
use crate::config::Config;
use crate::store::RecordStore;

/// The parts of a station; each worker gets those that it uses.
#[derive(Debug)]
pub struct Station {
    /// What all of them share.
    pub core: Arc<Core>,
    /// The button, the readers of ids and the light.
    pub booth: Arc<Booth>,
    /// The previews of held scans' legs.
    pub previews: Arc<Previews>,
    /// What operators can use.
    pub desk: Arc<Desk>,
}

impl Station {
    /// Takes over what the last run left in the state folder. A corrupt journal is set aside and
    /// rebuilt, with an alarm.
    ///
    /// # Errors
    /// See [`StationError`].
    pub fn open(
        config: Config,
        observer: Observer,
        first_start: bool,
    ) -> Result<Station, StationError> {
        let board = Board::new(Facts::new(Timestamp::now(), config.scanner.export_dirs.len()));
        measuring::confined(config.measure.confine, &board).map_err(StationError::Unconfined)?;
        let (scanner, patient) = (&config.scanner, &config.patient);
        let identity = Identity::new(
            scanner.file_name.clone(),
            patient.sidecar.clone(),
            &patient.pattern,
            patient.check_digit,
        )?;
        let stores = Stores::from_config(&config);
        let (custody, rebuilt) = open_custody(&config, &stores, first_start)?;
        // The station that lost its journal had begun these stores, so their marks must be found.
        let begun = stores.iter().filter(|_| !first_start);
        // First: what is to be erased must not be taken over.
        erase::clear_own(&custody, &stores, &config.station.state_dir);
        board.note(|facts| erase::note(&custody, facts));
        let recovered = recover(&custody, rebuilt, begun, &board);
        let adopted = recovered.map_err(|fault| failed(fault, &config, &custody))?;
        if let (Some(phantom), Some(series)) = (&config.phantom, custody.phantom_series()) {
            phantom::note(&board, phantom, series);
        }
        let previews = Arc::new(Previews::new(&config.station.state_dir));
        let core = Arc::new(Core::new(config, identity, custody, stores, board, observer));
        let booth = Booth::open(Arc::clone(&core)).map_err(CustodyFault::from);
        let booth = booth.map_err(|fault| failed(fault, &core.config, &core.custody))?;
        let booth = Arc::new(booth);
        let desk = Desk::new(Arc::clone(&core), Arc::clone(&booth), Arc::clone(&previews));
        info!(event = "station-open", adopted, first_start);
        Ok(Station { core, booth, previews, desk: Arc::new(desk) })
    }
}

/// Opens what the state folder holds. Returns why the journal was rebuilt, if it was.
pub(in crate::station) fn open_custody(
    config: &Config,
    stores: &Stores,
    first_start: bool,
) -> Result<(Custody, Option<String>), StationError> {
    let state_dir = &config.station.state_dir;
    let state = |source| StationError::State { path: state_dir.clone(), source };
    let names = stores.names();
    let (journal, rebuilt) = rebuild::open(&journal_file(config), &names, first_start)?;
    // After the journal: an existing spool means that there was a journal, so a missing one was lost.
    let custody = Custody::open(state_dir, journal, names, config.retention.spool);
    let mut custody = custody.map_err(state)?;
    let phantom = config.phantom.as_ref().map(|_| PhantomSeries::open(state_dir));
    custody.phantom = phantom.transpose().map_err(state)?;
    custody.named_only = stores.named_only();
    let custody = custody.with_servers(stores.servers()).map_err(StationError::Recovery)?;
    Ok((custody, rebuilt))
}

/// Takes over what the last run left; `begun` are the stores that a rebuilt journal must learn of. Notes
/// what operators must know. Returns how many scans the journal did not have.
fn recover<'a>(
    custody: &Custody,
    rebuilt: Option<String>,
    begun: impl Iterator<Item = &'a dyn RecordStore>,
    board: &Board,
) -> Result<usize, CustodyFault> {
    let (is_paused, views) = (custody.journal().is_paused()?, custody.journal().views()?);
    board.note(|facts| {
        facts.intake = if is_paused { IntakeState::Paused } else { IntakeState::Open };
        facts.views = views;
    });
    let adopted = custody.recover()?;
    if let Some(why) = rebuilt {
        let quarantined = custody.adopt_quarantined()?;
        for store in begun {
            custody.journal().begun(store.name(), &store.place())?;
        }
        custody.journal().filled()?;
        error!(event = "journal-rebuilt", why, adopted, quarantined);
        board.raise("journal-rebuilt", ComplaintFigures::why(&Cause::verbatim(why)));
    }
    // After the scans, which a lost journal must learn of first.
    let unreadable = custody.carry_out()?;
    if !unreadable.is_empty() {
        board.raise("decisions-unreadable", ComplaintFigures::counted(unreadable.len()));
    }
    Ok(adopted)
}

/// Handles a failed start. If the journal is corrupt it is set aside: the next start finds none and
/// makes a new one.
fn failed(fault: CustodyFault, config: &Config, custody: &Custody) -> StationError {
    if JournalError::among_causes(&fault).is_some_and(JournalError::is_ruin)
        && let Err(error) = rebuild::give_up(&journal_file(config), custody.journal())
    {
        return error;
    }
    StationError::Recovery(fault)
}
