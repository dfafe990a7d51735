//! What a record, its report, its figures and its messages say.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod completeness;
mod every_finding;
mod export_figures;
mod fhir_resources;
mod figure_claims;
mod figure_sides;
mod figures;
mod from_extraction;
mod gdt_message;
mod gdt_orders;
mod hl7_message;
mod levels;
mod one_order;
mod pseudonymous;
mod report_content;
mod report_page;
mod report_paper;
mod report_words;
mod sizing;
mod sizing_report;
mod tilt;
