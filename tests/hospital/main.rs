//! The stores of hospitals against real servers: Medplum's FHIR router, a receiver of HL7 v2 by hl7apy, archives of
//! images by pynetdicom and Orthanc, wlmscpfs as the worklist, and moto as the store of objects of an archive of many
//! stations.
//!
//! Faults are injected in front of each server; what validates, searches and keeps is its own. `.ci/run`
//! installs them. By hand:
//!
//! ```text
//! npm --prefix tests/hospital ci
//! python3 -m venv /tmp/venv && /tmp/venv/bin/pip install hl7apy jsonschema pynetdicom highdicom 'moto[server]' boto3
//! apt-get install --no-install-recommends orthanc orthanc-dicomweb dcmtk dicom3tools curl
//! GAITER_PYTHON=/tmp/venv/bin/python cargo test --test hospital -- --include-ignored --skip orthanc_ --skip worklist::wlmscpfs
//! unshare -n sh -c 'ip link set lo up; cargo test --test hospital orthanc_ -- --ignored'
//! unshare -n sh -c 'ip link set lo up; cargo test --test hospital worklist::wlmscpfs -- --ignored'
//! ```

mod archive;
mod dicom;
mod dicom_faults;
mod dicom_house;
mod fhir;
mod fhir_access;
mod fhir_faults;
mod fhir_house;
mod hl7;
mod hl7_faults;
mod hl7_house;
mod kill;
mod orthanc;
mod records;
mod server;
mod station;
mod worklist;
