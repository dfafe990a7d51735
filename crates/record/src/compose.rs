//! Extraction and provenance → [`Record`], with every figure rounded by the same rule.

use std::collections::BTreeMap;

use gaiter_leg::frame::body::FacingFrom;
use gaiter_leg::levels::girth::GirthCurve;
use gaiter_leg::method::{B1, Tape, UnitChoice};
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::axis_length::AxisLength;
use gaiter_leg::{Estimate, Extraction, Finding, Landmark, LegReport, LevelSection, Method};

use super::chart::{self, codes, known};
use super::provenance::Provenance;
use super::rounding::{degrees, mm, per_mm, share};
use super::schema::{
    BodyFigures, EstimateFigures, FeatureFigures, FindingNote, FootFigures, GirthColumns,
    LandmarkFigures, LegFigures, MadeBy, Record, SCHEMA, ScanFile, SectionFigures,
};
use super::shape;
use super::statement::Statement;
use super::surface::surface;

/// Makes the record of an extraction.
pub fn record(extraction: &Extraction, provenance: &Provenance, method: &Method) -> Record {
    let (body, crotch) = (&extraction.body, &extraction.crotch);
    Record {
        schema: SCHEMA.to_owned(),
        revision: provenance.revision,
        station: provenance.station.clone(),
        patient: provenance.patient.clone(),
        acquired: provenance.acquired.clone(),
        made_by: MadeBy {
            gaiter: env!("CARGO_PKG_VERSION").to_owned(),
            method: method_words(method),
        },
        phantom_check: provenance.phantom_check.clone(),
        scan: ScanFile {
            sha256: provenance.sha256.clone(),
            format: extraction.export.format.ending().to_owned(),
            unit: body.unit.word().to_owned(),
            unit_inferred: body.unit_inferred,
            points: extraction.export.points,
            triangles: extraction.export.triangles,
        },
        body: BodyFigures {
            stature_mm: body.stature_mm.map(mm),
            crotch_height_mm: crotch.is_seen().then(|| mm(crotch.height_mm)),
            crotch_sd_mm: crotch.is_seen().then(|| mm(crotch.sd_mm.hypot(body.floor_sd_mm))),
            crotch_from: crotch.from.word().to_owned(),
            floor_sd_mm: known(body.floor_sd_mm, mm),
            facing_deg: degrees(body.facing_deg),
            facing_from: match body.facing_from {
                FacingFrom::Feet => "feet".to_owned(),
                FacingFrom::Calves(_) => "calves".to_owned(),
                FacingFrom::Declared(_) => "declared".to_owned(),
            },
            from_export: std::array::from_fn(|i| body.from_export[(i / 4, i % 4)]),
        },
        legs: extraction.legs.iter().map(|report| leg(report, method)).collect(),
        differences: extraction.differences.as_ref().map(chart::differences),
        findings: extraction.findings.iter().map(note).collect(),
        amendments: provenance.amendments.clone(),
    }
}

fn method_words(method: &Method) -> BTreeMap<String, String> {
    let unit = match method.unit {
        UnitChoice::Auto => "auto",
        UnitChoice::Declared(unit) => unit.word(),
    };
    let words = [
        ("scope", method.scope.word()),
        ("unit", unit),
        ("up", method.up.word()),
        ("facing", method.facing.word()),
        ("winding", method.winding.word()),
        ("posture", method.posture.word()),
        ("volume", method.volume.word()),
        ("fit", method.fit.word()),
        ("tape", method.tape.word()),
        ("b1", method.levels.b1.word()),
    ];
    let mut words = BTreeMap::from(words.map(|(key, word)| (key, word.to_owned())));
    words.insert("g_below_crotch", format!("{}mm", method.levels.g_below_crotch_mm));
    if let Tape::Leg(axis) = method.tape {
        words.insert("axis", axis.word().to_owned());
    }
    if let B1::AboveB { distance_mm } = method.levels.b1 {
        words.insert("b1_above_b", format!("{distance_mm}mm"));
    }
    if !method.at_heights_mm.is_empty() {
        let heights = method.at_heights_mm.iter().map(|height| mm(*height).to_string());
        words.insert("at_heights_mm", heights.collect::<Vec<_>>().join(", "));
    }
    words.into_iter().map(|(key, word)| (key.to_owned(), word)).collect()
}

fn leg(report: &LegReport, method: &Method) -> LegFigures {
    let landmarks = report.landmarks.iter();
    LegFigures {
        side: report.side.word().to_owned(),
        tilt_deg: degrees(report.axis.tilt_deg()),
        axis: shape::axis(&report.axis),
        axes: (method.tape == Tape::Shank).then(|| shape::axes(&report.axis)),
        landmarks: landmarks.map(|l| (l.level.name().to_owned(), landmark(report, l))).collect(),
        estimates: estimates(report),
        foot: report.foot.map(|foot| FootFigures {
            length_mm: mm(foot.length_mm),
            breadth_mm: mm(foot.breadth_mm),
        }),
        girth_curve: girth_columns(&report.girth_curve, &report.lengths),
        sections: report.level_sections.iter().map(|at| section(&report.axis, at)).collect(),
        features: report.level_sections.iter().flat_map(features).collect(),
        surface: surface(report),
        volume: chart::volumes(report, method.volume),
        at: report.at.iter().map(|at| chart::at(at, &report.lengths)).collect(),
        profile: report.profile.iter().map(|at| chart::at(at, &report.lengths)).collect(),
        along: report.along.iter().map(chart::along).collect(),
        shape: shape::shape(report),
    }
}

fn landmark(report: &LegReport, landmark: &Landmark) -> LandmarkFigures {
    let own = report.level_sections.iter().find(|at| at.level == landmark.level);
    let centre = own.map(|at| report.axis.at(at.section.along_mm, &at.section.centre));
    LandmarkFigures {
        by: Statement::from(landmark.by.said()).in_english(),
        rule: Statement::from(landmark.by.said()),
        height_mm: mm(landmark.height_mm),
        along_axis_mm: mm(report.lengths.at(landmark.along_mm)),
        centre_mm: centre.map(|centre| centre.coords.map(mm).into()),
        surface_length_mm: landmark.surface_length_mm.map(mm),
        girth_tape_mm: mm(landmark.girth_tape_mm),
        girth_contour_mm: mm(landmark.girth_contour_mm),
        height_sd_mm: known(landmark.height_sd_mm, mm),
        girth_sd_mm: known(landmark.girth_sd_mm, mm),
        girth_of_level_sd_mm: known(landmark.girth_of_level_sd_mm, mm),
        girth_per_deg_mm: landmark.girth_per_deg_mm.map(mm),
        doubts: codes(&landmark.doubts),
    }
}

fn estimates(report: &LegReport) -> BTreeMap<String, EstimateFigures> {
    let figures = |estimate: &Estimate| EstimateFigures {
        by: Statement::from(estimate.by.said()).in_english(),
        rule: Statement::from(estimate.by.said()),
        height_mm: mm(estimate.height_mm),
        along_axis_mm: mm(report.lengths.at(estimate.along_mm)),
        girth_tape_mm: mm(estimate.girth_tape_mm),
        height_sd_mm: known(estimate.height_sd_mm, mm),
        girth_sd_mm: known(estimate.girth_sd_mm, mm),
        girth_of_level_sd_mm: known(estimate.girth_of_level_sd_mm, mm),
        doubts: codes(&estimate.doubts),
    };
    report.estimates.iter().map(|one| (one.level.name().to_owned(), figures(one))).collect()
}

fn girth_columns(curve: &GirthCurve, lengths: &AxisLength) -> GirthColumns {
    let column = |value: fn(f64, &gaiter_leg::sections::section::Girth) -> f64| {
        let cell = |row: &gaiter_leg::levels::girth::GirthRow| {
            row.measured.as_ref().map(|(height_mm, girth)| mm(value(*height_mm, girth)))
        };
        curve.rows.iter().map(cell).collect()
    };
    let (from_mm, to_mm) = curve.domain();
    let slope = |along_mm: f64| {
        let is_within = (from_mm..=to_mm).contains(&along_mm);
        is_within.then(|| share(curve.tape(along_mm)[1]))
    };
    GirthColumns {
        height_mm: column(|height_mm, _| height_mm),
        along_axis_mm: curve.rows.iter().map(|row| mm(lengths.at(row.along_mm))).collect(),
        tape_mm: column(|_, girth| girth.tape_mm),
        contour_mm: column(|_, girth| girth.contour_mm),
        slope: curve.rows.iter().map(|row| slope(row.along_mm)).collect(),
        r2: share(curve.r2()),
        rms_mm: mm(curve.rms_mm()),
    }
}

fn section(axis: &LegAxis, at: &LevelSection) -> SectionFigures {
    SectionFigures {
        level: at.level.name().to_owned(),
        height_mm: mm(at.section.height_mm),
        r2: share(at.section.r2),
        rms_mm: mm(at.section.rms_mm),
        largest_gap_deg: degrees(at.section.largest_gap_deg),
        outline: shape::outline(axis, at),
    }
}

fn features(at: &LevelSection) -> impl Iterator<Item = FeatureFigures> + '_ {
    at.features.iter().enumerate().map(|(index, feature)| FeatureFigures {
        level: at.level.name().to_owned(),
        label: format!("P{}", index + 1),
        kind: feature.kind.word().to_owned(),
        angle_deg: degrees(feature.angle_deg),
        position_mm: std::array::from_fn(|axis| mm(feature.position[axis])),
        position_sd_mm: known(feature.position_sd_mm, mm),
        curvature_per_mm: per_mm(feature.curvature_per_mm),
        prominence_per_mm: per_mm(feature.prominence_per_mm),
    })
}

fn note(finding: &Finding) -> FindingNote {
    let says = Statement::of_finding(&finding.what);
    FindingNote {
        code: finding.code().to_owned(),
        severity: finding.severity().word().to_owned(),
        leg: finding.side.map(|side| side.word().to_owned()),
        level: finding.level.map(|level| level.name().to_owned()),
        message: says.in_english(),
        says: Some(says),
    }
}
