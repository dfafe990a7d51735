//! The measurement: truth, closed forms, laws, findings.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod at_heights;
mod closed_forms;
mod cloud;
mod crop;
mod curvature;
mod features;
mod findings;
mod found;
mod held_back;
mod laws;
mod levels;
mod order;
mod paper;
mod parting;
mod second_opinion;
mod strips;
mod surface;
mod test_leg_itself;
mod true_skin;
mod truth;
mod volume;
mod wild;
