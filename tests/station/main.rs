//! The station as the real program, as technicians, operators and monitors meet it.

mod amend;
mod archive;
mod booth;
mod companions;
mod confinement;
mod control;
mod custody;
mod decisions;
mod deliveries;
mod gdt;
mod http;
mod journal;
mod life;
mod measure;
mod names;
mod orders;
mod page;
mod persons;
mod phantom;
mod servers;
mod sizes;
mod trigger_pty;
mod trigger_scripts;
mod watch;
