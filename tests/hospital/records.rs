//! Records as a station makes them, and what their measuring sheets say.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use gaiter::store::Delivery;
use gaiter_cad::Output;
use gaiter_flow::ScanId;
use gaiter_leg::{Format, Method, Side};
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::shape::ShapeFigures;
use gaiter_record::{
    Acquired, AcquiredFrom, ImagingRequest, Patient, Provenance, Record, RecordFile, ReportChoice,
    ScanFile, Source, SourceKind, record_files, sha256,
};
use support::recorded::export;
use support::records::measured;

/// The patient of the records.
pub const PATIENT: &str = "4711";

/// A scan that can be delivered, and its record.
pub struct Scan {
    pub id: ScanId,
    pub record: Record,
    pub files: Vec<RecordFile>,
}

/// Records of the recorded bodies with all their files.
pub static SCANS: LazyLock<[Scan; 3]> =
    LazyLock::new(|| ["f_average_clean", "f_average_tc2", "m_average_clean"].map(scan_of));

/// A record without what no message has, for tests with many deliveries.
pub static SMALL: LazyLock<Scan> = LazyLock::new(|| {
    let mut record = SCANS[1].record.clone();
    for leg in &mut record.legs {
        let curve = &mut leg.girth_curve;
        for column in
            [&mut curve.height_mm, &mut curve.tape_mm, &mut curve.contour_mm, &mut curve.slope]
        {
            column.clear();
        }
        curve.along_axis_mm.clear();
        leg.sections.clear();
        leg.features.clear();
        leg.profile.clear();
        leg.along.clear();
        leg.shape = ShapeFigures::default();
    }
    SCANS[1].with(record, &["record.json"])
});

fn scan_of(body: &str) -> Scan {
    let bytes = export(body);
    let sources = vec![Source::from_kind(SourceKind::Reader)];
    let acquired = Acquired::new("2026-11-19T23:30:00Z".parse().unwrap(), AcquiredFrom::Press);
    let provenance = Provenance {
        station: Some("booth-1".to_owned()),
        patient: Some(Patient { id: PATIENT.to_owned(), sources }),
        acquired: Some(Acquired { utc_offset_min: Some(60), ..acquired }),
        ..Provenance::of_scan(sha256(&bytes))
    };
    let scan = ScanFile { bytes: &bytes, format: Format::Obj, ord: None };
    let (method, output, choice) = (Method::default(), Output::default(), ReportChoice::default());
    let (extraction, _) = measured(body);
    let (record, files) =
        record_files(extraction, &provenance, &method, &output, &choice, scan).unwrap();
    Scan { id: ScanId::parse(&provenance.sha256).unwrap(), record, files }
}

impl Scan {
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery {
            scan: &self.id,
            patient: self.record.patient.as_ref().map(|patient| patient.id.as_str()),
            person: None,
            first_seen: "2026-11-20T08:00:00Z".parse().unwrap(),
            revision: self.record.revision,
            turn: 0,
            files: &self.files,
            scan_file: Path::new("/dev/null"),
            ending: "obj",
        }
    }

    /// The same after a person set the girth of C on the right leg.
    pub fn amended(&self, girth_mm: f64) -> Scan {
        let amendment = Amendment {
            leg: "right".to_owned(),
            measure: "C".to_owned(),
            is: Deed::Measured,
            girth_mm: Some(girth_mm),
            height_mm: None,
            length_mm: None,
            reason: "swollen".to_owned(),
            by: "Anna Berg".to_owned(),
            at: "2026-11-20T10:00:00Z".parse().unwrap(),
        };
        let mut record = self.record.amended(&[amendment], true).unwrap();
        record.revision += 1;
        self.with(record, &[])
    }

    /// The same scan for another patient.
    pub fn of_patient(&self, patient: &str) -> Scan {
        let mut record = self.record.clone();
        record.patient.as_mut().unwrap().id = patient.to_owned();
        self.with(record, &[])
    }

    /// The same scan, which answers this request of a worklist.
    pub fn answering(&self, request: Option<ImagingRequest>) -> Scan {
        let mut record = self.record.clone();
        let sources = vec![Source::from_kind(SourceKind::Operator).with_request(request)];
        record.patient = Some(Patient { id: PATIENT.to_owned(), sources });
        self.with(record, &[])
    }

    /// Another scan with the same record.
    pub fn numbered(&self, number: usize) -> Scan {
        let id = ScanId::parse(&format!("{number:064x}")).unwrap();
        Scan { id, record: self.record.clone(), files: self.files.clone() }
    }

    /// The same scan with another record, and of its files those of these names, or all.
    pub fn with(&self, record: Record, names: &[&str]) -> Scan {
        let is_kept = |of: &&RecordFile| names.is_empty() || names.contains(&of.name.as_str());
        let mut files: Vec<RecordFile> = self.files.iter().filter(is_kept).cloned().collect();
        let json = files.iter_mut().find(|file| file.name == "record.json").unwrap();
        json.bytes = serde_json::to_vec(&record).unwrap();
        Scan { id: self.id.clone(), record, files }
    }

    /// The figures of a leg on the measuring sheet that are not estimated, cm, by the code of their box: `cB`
    /// and `lB` for girth and height of B.
    pub fn sheet(&self, side: Side) -> BTreeMap<String, String> {
        let table = self.files.iter().find(|file| file.name == "measurements.csv").unwrap();
        let table = String::from_utf8(table.bytes.clone()).unwrap();
        let mut sheet = BTreeMap::new();
        for line in table.lines() {
            let cells: Vec<&str> = line.split(',').collect();
            let [leg, level, "measured", girth, height, ..] = cells[..] else { continue };
            let lengths =
                [('c', girth), ('l', height)].into_iter().filter(|(_, cm)| !cm.is_empty());
            let lengths = lengths.filter(|_| leg == side.word());
            sheet.extend(lengths.map(|(letter, cm)| (format!("{letter}{level}"), cm.to_owned())));
        }
        assert!(sheet.len() > 6, "{sheet:?}");
        sheet
    }
}
