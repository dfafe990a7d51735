//! Something of every kind that a record can say of its scan.

use gaiter_leg::comparison::difference::LegsDiffer;
use gaiter_leg::comparison::opinion::{Measure, SecondOpinion};
use gaiter_leg::doubt::Doubt;
use gaiter_leg::frame::soles::FloorDoubt;
use gaiter_leg::frame::stance::FeetUnclear;
use gaiter_leg::levels::at_height::NoGirth;
use gaiter_leg::levels::extremum::Absence;
use gaiter_leg::sections::axis_fit::{AxisFault, NoThigh};
use gaiter_leg::surface::nurbs::NoSurface;
use gaiter_leg::{LegFault, Level, Side, What};

/// Something of every kind, with figures that are told apart.
pub fn all() -> Vec<What> {
    let feet = [
        FeetUnclear::NotSeen { points: 7 },
        FeetUnclear::NoFoot { length_percent: 31.0, width_percent: 12.0 },
        FeetUnclear::NoToes { ratio: 1.25 },
        FeetUnclear::Apart { spread_deg: 95.0 },
        FeetUnclear::NotSquare { off_deg: 62.0 },
    ];
    let absences = [
        Absence::NoTurn,
        Absence::BelowSearch { along_mm: 61.0 },
        Absence::AboveSearch { along_mm: 402.0 },
        Absence::Needs { level: Level::B },
        Absence::Beyond { level: Level::D },
    ];
    let doubts = [
        Doubt::Shallow { prominence_mm: 1.2 },
        Doubt::Flat { height_sd_mm: 21.0 },
        Doubt::GirthUncertain { girth_sd_mm: 8.0 },
        Doubt::Double { other_height_mm: 372.0 },
        Doubt::Several { other_height_mm: 395.0 },
        Doubt::UnusualHeight { percent: 13.0 },
        Doubt::Edge { end_mm: 8.0 },
        Doubt::Gap { gap_deg: 39.0 },
        Doubt::Scatter { rms_mm: 2.4 },
        Doubt::Cloth { step_mm: 11.0, height_mm: 92.0 },
        Doubt::ViewsApart { step_mm: 3.2, girth_off_mm: 8.2 },
        Doubt::Smoothed { girth_off_mm: 10.4 },
        Doubt::Folds { percent: 3.1 },
        Doubt::NotSeen,
        Doubt::KneeBent { bend_deg: 52.0 },
        Doubt::BelowD { d_height_mm: 431.0 },
        Doubt::SoleNotSeen,
    ];
    let faults = [
        LegFault::NotThere,
        LegFault::Axis(AxisFault::TooFewSections { found: 3, needed: 10 }),
        LegFault::Axis(AxisFault::TooFewPoints { found: 4, needed: 100 }),
        LegFault::Axis(AxisFault::Leaning { tilt_deg: 41.0 }),
        LegFault::TooFewPoints,
        LegFault::TooFewSections { measured: 5, planes: 190 },
    ];
    let surfaces = [
        NoSurface::TooFewRows { rows: 4, needed: 9, from_mm: 98.0, to_mm: 436.0 },
        NoSurface::Folded { height_mm: 211.0 },
        NoSurface::NothingSeen,
    ];
    let no_girths = [NoGirth::Outside { from_mm: 52.0, to_mm: 741.0 }, NoGirth::NotSeen];
    let hole = |count| What::SurfaceHoles {
        count,
        length_mm: 45.0,
        width_mm: 50.0,
        height_mm: 492.0,
        angle_deg: -160.0,
    };
    let differ = Side::BOTH.into_iter().flat_map(|larger| {
        [
            LegsDiffer::Girth { larger, by_mm: 46.0, sd_mm: 0.4 },
            LegsDiffer::Volume { larger, by_ml: 337.0, percent: 12.5, sd_ml: 27.0 },
        ]
    });
    let opinions = [
        SecondOpinion::Ambiguous { files: 2 },
        SecondOpinion::Unit { theirs_mm: 176.0, ours_mm: 1760.0, factor: 10.0 },
        SecondOpinion::Sides { left_mm: 361.0, right_mm: 384.0 },
    ];
    let measures = [Measure::Stature, Measure::Calf, Measure::Ankle];
    let disagrees = measures.map(|measure| SecondOpinion::Disagrees {
        measure,
        theirs_mm: 390.0,
        ours_mm: 412.0,
    });
    let mut all = vec![
        What::LevelImplausible { girth_mm: 1301.0 },
        What::MirrorUnchecked,
        What::NoFaces,
        What::NoLineEnd,
        What::FloorUnclear(FloorDoubt::Uneven { spread_mm: 14.0 }),
        What::FloorUnclear(FloorDoubt::NotTurning),
        What::FloorUnclear(FloorDoubt::Raised { toes_mm: 44.0 }),
        What::Coarse { spacing_mm: 13.6, girth_off_mm: 2.2 },
        What::FootForward { by_mm: 210.0 },
        What::ThighsTouch { from_mm: 702.0 },
        What::Proportions { percent: 41.0 },
        What::CrownNotSeen { stature_mm: 1650.0 },
        What::ThighAxisMissing { why: NoThigh::NotSeen },
        What::ThighAxisMissing { why: NoThigh::TooBent { bend_deg: 61.0 } },
        What::CrotchUncertain { sd_mm: 15.3 },
        What::CrotchNotSeen,
        What::LegCut { end_mm: 512.0 },
        What::SurfaceShort {
            from_mm: 120.0,
            to_mm: 410.0,
            wanted_from_mm: 98.0,
            wanted_to_mm: 436.0,
        },
        What::HolesFilled { count: 1, length_mm: 80.0, width_mm: 40.0, height_mm: 120.0 },
        What::HolesFilled { count: 2, length_mm: 80.0, width_mm: 40.0, height_mm: 120.0 },
        hole(1),
        hole(3),
    ];
    all.extend(feet.map(|why| What::FacingUnchecked { why }));
    all.extend(feet.map(|why| What::FacingByCalves { why }));
    all.extend(absences.map(|why| What::LevelAbsent { why }));
    all.extend(doubts.map(What::Doubtful));
    all.extend(faults.map(|why| What::LegNotMeasured { why }));
    all.extend(surfaces.map(What::NoSurface));
    all.extend(no_girths.map(|why| What::HeightNotMeasured { height_mm: 305.0, why }));
    all.extend(differ.map(What::LegsDiffer));
    all.extend(opinions.into_iter().chain(disagrees).map(What::SecondOpinion));
    all
}
