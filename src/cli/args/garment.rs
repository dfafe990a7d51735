//! The garment that is ordered, for every verb that lists what an order needs.

use std::path::PathBuf;

use gaiter_sizes::Garment;

use crate::cli::sizes::read_all;
use crate::cli::{Exit, complain, terminal_safe};
use crate::config::sizes::add;

/// The garment.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct GarmentArgs {
    /// The garment that is ordered: AD, AF, AG, AT, or one of --garment-file or of the configuration
    #[arg(long, value_name = "NAME")]
    pub garment: Option<String>,
    /// A file with a garment of your own (gaiter-garment/1), or a folder of them
    #[arg(long, value_name = "FILE")]
    pub garment_file: Option<PathBuf>,
}

impl GarmentArgs {
    /// The garments known otherwise, with those of the file in place of or after them.
    ///
    /// # Errors
    /// The exit of the verb if the file cannot be read or has faults; all are printed.
    pub fn known(&self, known: &[Garment]) -> Result<Vec<Garment>, Exit> {
        let mut all = known.to_vec();
        self.of_files()?.into_iter().for_each(|garment| add(&mut all, garment));
        Ok(all)
    }

    /// The garment of the command line: the one named, else that of the file, else the usual one.
    ///
    /// # Errors
    /// The exit of the verb if there is no such garment, or if the file has faults; both are printed.
    pub fn chosen(&self, known: &[Garment], usual: &Garment) -> Result<Garment, Exit> {
        let mut all = known.to_vec();
        let own = self.of_files()?;
        own.iter().cloned().for_each(|garment| add(&mut all, garment));
        match (&self.garment, own.as_slice()) {
            (Some(name), _) => all.iter().find(|of| of.name() == name).cloned().ok_or_else(|| {
                let names: Vec<&str> = all.iter().map(Garment::name).collect();
                let (name, names) = (terminal_safe(name), terminal_safe(names.join(", ")));
                complain(format_args!("gaiter: --garment {name}: known are {names}"));
                Exit::Usage
            }),
            (None, [garment]) => Ok(garment.clone()),
            (None, []) => Ok(usual.clone()),
            (None, _) => {
                complain("gaiter: --garment-file has several garments; --garment NAME chooses one");
                Err(Exit::Usage)
            }
        }
    }

    fn of_files(&self) -> Result<Vec<Garment>, Exit> {
        let files = self.garment_file.as_deref();
        files.map_or(Ok(Vec::new()), |files| read_all(files, Garment::read))
    }
}
