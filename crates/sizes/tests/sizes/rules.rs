//! What a verdict rests on: required points, variants, lengths, what is missing, and the basis.

#![allow(clippy::unwrap_used)]

use gaiter_leg::Level;
use gaiter_sizes::table::SizeTable;
use gaiter_sizes::verdict::{
    Fit, Given, LegVerdict, NotComparable, NotGiven, Reading, SizeVerdict, leg_verdict,
};
use gaiter_sizes::{Garment, Point, parse};

/// The head of a table; ranges follow.
pub const HEAD: &str = "format = \"gaiter-size-table/1\"\nid = \"t\"\nmaker = \"m\"\nproduct = \"p\"\n\
    table_edition = \"e\"\nsource = \"s\"\nstatus = \"test-only\"\nunit = \"cm\"\nlimits = \"closed\"\n\
    decides = \"cB\"\nmatch = \"all\"\nlengths_from = \"floor\"\nskin_or_tension = \"skin\"\n";

pub fn table(more: &str) -> SizeTable {
    table_of(&format!("{HEAD}{more}"))
}

pub fn table_of(text: &str) -> SizeTable {
    parse(text.as_bytes()).unwrap_or_else(|faults| {
        let said: Vec<String> = faults.iter().map(ToString::to_string).collect();
        unreachable!("{}\n{text}", said.join("\n"))
    })
}

pub fn given(mm: f64, uncertainty_mm: Option<f64>) -> Reading {
    Reading::Given(Given { mm, uncertainty_mm, is_by_hand: false })
}

/// Points by name with their values in mm and a standard uncertainty of 1 mm; others are not found.
pub fn leg(points: &[(&str, f64)]) -> impl Fn(Point) -> Reading {
    let points: Vec<(Point, f64)> =
        points.iter().map(|(name, mm)| (Point::named(name).unwrap(), *mm)).collect();
    move |point| match points.iter().find(|(its, _)| *its == point) {
        Some((_, mm)) => given(*mm, Some(1.0)),
        None => Reading::NotGiven { why: NotGiven::NotFound },
    }
}

fn verdict(table: &SizeTable, garment: &str, points: &[(&str, f64)]) -> LegVerdict {
    leg_verdict(table, &Garment::named(garment).unwrap(), leg(points)).unwrap()
}

fn size<'a>(of: &'a LegVerdict, name: &str, variant: Option<&str>) -> &'a SizeVerdict {
    let is_it = |of: &&SizeVerdict| of.size == name && of.variant.as_deref() == variant;
    of.sizes.iter().find(is_it).unwrap()
}

const CALF: &str = "[[size]]\nname = \"I\"\ncB = [18, 20]\ncC = [28, 34]\n\
                    [[size]]\nname = \"II\"\ncB = [20, 22]\ncC = [30, 37]\n";

#[test]
fn a_size_fits_if_every_required_point_surely_does() {
    let of = verdict(&table(CALF), "AD", &[("cB", 190.0), ("cC", 310.0)]);
    assert_eq!((size(&of, "I", None).fit, size(&of, "II", None).fit), (Fit::Fits, Fit::DoesNotFit));
    assert!(size(&of, "I", None).is_candidate && !size(&of, "II", None).is_candidate);
    let of = verdict(&table(CALF), "AD", &[("cB", 190.0), ("cC", 345.0)]);
    assert_eq!(size(&of, "I", None).fit, Fit::DoesNotFit, "the calf is too large");
    assert!(size(&of, "I", None).is_candidate, "the ankle decides what is shown");
    assert_eq!(of.fit, Fit::DoesNotFit);
}

#[test]
fn the_worst_required_point_counts_and_nothing_is_multiplied() {
    // Both points lie 1.7 standard uncertainties inside: 0.955 each, 0.91 as a product.
    let of = verdict(&table(CALF), "AD", &[("cB", 198.3), ("cC", 338.3)]);
    assert_eq!(size(&of, "I", None).fit, Fit::Fits);
    let probabilities: Vec<f64> =
        size(&of, "I", None).points.iter().map(|of| of.probability.unwrap()).collect();
    assert!(probabilities.iter().all(|share| (0.95..0.96).contains(share)), "{probabilities:?}");
}

#[test]
fn a_girth_near_a_common_limit_makes_candidates_of_both_sizes() {
    let of = verdict(&table(CALF), "AD", &[("cB", 200.0), ("cC", 320.0)]);
    for name in ["I", "II"] {
        let of = size(&of, name, None);
        assert!(of.is_candidate && of.fit == Fit::FitsWithinUncertainty, "{name}");
        assert!((of.points[0].probability.unwrap() - 0.5).abs() < 1e-9);
    }
}

#[test]
fn a_value_in_a_gap_fits_nothing_and_a_value_within_uncertainty_of_a_limit_may_fit() {
    let gap =
        table("[[size]]\nname = \"I\"\ncB = [18, 20]\n[[size]]\nname = \"II\"\ncB = [21, 23]\n");
    let of = verdict(&gap, "AD", &[("cB", 205.0)]);
    assert!(of.sizes.iter().all(|of| !of.is_candidate && of.fit == Fit::DoesNotFit));
    let of = verdict(&gap, "AD", &[("cB", 201.0)]);
    assert_eq!(size(&of, "I", None).fit, Fit::FitsWithinUncertainty, "outside by one uncertainty");
    assert_eq!(size(&of, "II", None).fit, Fit::DoesNotFit);
}

#[test]
fn in_an_overlap_both_sizes_fit_in_the_order_of_the_table() {
    let overlap =
        table("[[size]]\nname = \"7\"\ncB = [29, 31]\n[[size]]\nname = \"8\"\ncB = [30, 33]\n");
    let of = verdict(&overlap, "AD", &[("cB", 305.0)]);
    let fits: Vec<(&str, Fit)> = of.sizes.iter().map(|of| (of.size.as_str(), of.fit)).collect();
    assert_eq!(fits, [("7", Fit::Fits), ("8", Fit::Fits)]);
}

#[test]
fn a_variant_replaces_the_ranges_it_names_and_no_others() {
    let wide = table(
        "[[variant]]\nname = \"wide\"\napplies_to = [\"AG\"]\nreplaces = [\"cG\"]\n[[size]]\nname = \"I\"\n\
         cB = [18, 20]\ncG = [48, 56]\nvariant.wide.cG = [57, 64]\n[[size]]\nname = \"II\"\n\
         cB = [20, 22]\ncG = [51, 60]\n",
    );
    let thigh = [("cB", 190.0), ("cG", 600.0)];
    let of = verdict(&wide, "AG", &thigh);
    assert_eq!(size(&of, "I", None).fit, Fit::DoesNotFit);
    assert_eq!(size(&of, "I", Some("wide")).fit, Fit::Fits);
    assert_eq!(of.sizes.len(), 3, "the size II is not made in the variant");
    let of = verdict(&wide, "AD", &thigh);
    assert_eq!(of.sizes.len(), 2, "the variant is not made for AD");
    assert_eq!(size(&of, "I", None).fit, Fit::Fits, "a calf stocking has no cG");
}

#[test]
fn lengths_are_judged_beside_sizes_and_both_must_fit() {
    let lengths = table(&format!(
        "{CALF}[[length]]\ngarment = \"AD\"\nname = \"short\"\nlD = [34, 38.9]\n\
         [[length]]\ngarment = \"AD\"\nname = \"normal\"\nlD = [39, 44]\n"
    ));
    let calf = [("cB", 190.0), ("cC", 310.0)];
    let with = |mm: f64| verdict(&lengths, "AD", &[calf[0], calf[1], ("lD", mm)]);
    let fits = |of: &LegVerdict| of.lengths.iter().map(|of| of.fit).collect::<Vec<_>>();
    assert_eq!(fits(&with(360.0)), [Fit::Fits, Fit::DoesNotFit]);
    assert_eq!(with(360.0).fit, Fit::Fits);
    assert_eq!(fits(&with(389.5)), [Fit::FitsWithinUncertainty; 2], "in the gap of a millimetre");
    assert_eq!(fits(&with(470.0)), [Fit::DoesNotFit; 2]);
    assert_eq!(with(470.0).fit, Fit::DoesNotFit, "the size fits, no length does");
    assert_eq!(verdict(&lengths, "AD", &calf).fit, Fit::NotDecided, "lD is not given");
    assert_eq!(verdict(&lengths, "AG", &calf).lengths, [], "no length is of AG");
}

#[test]
fn a_point_that_is_not_given_leaves_the_size_open_unless_another_decides() {
    let of = verdict(&table(CALF), "AD", &[("cB", 190.0)]);
    let one = size(&of, "I", None);
    assert_eq!((one.fit, &one.missing[..]), (Fit::NotDecided, &[Point::Girth(Level::C)][..]));
    assert_eq!(size(&of, "II", None).fit, Fit::DoesNotFit, "the ankle is too small whatever C is");
    let of = verdict(&table(CALF), "AD", &[("cC", 320.0)]);
    assert!(of.sizes.iter().all(|of| of.is_candidate && of.fit == Fit::NotDecided));
}

#[test]
fn what_the_table_requires_must_fit_and_the_rest_is_told() {
    let ankle = table(&format!("required = [\"cB\"]\n{CALF}"));
    let of = verdict(&ankle, "AD", &[("cB", 190.0), ("cC", 400.0)]);
    let one = size(&of, "I", None);
    assert_eq!(one.fit, Fit::Fits);
    let required: Vec<bool> = one.points.iter().map(|of| of.is_required).collect();
    assert_eq!((required, one.points[1].fit), (vec![true, false], Fit::DoesNotFit));
    let by_garment =
        table(&format!("required.AD = [\"cB\"]\nrequired.AG = [\"cB\", \"cC\"]\n{CALF}"));
    let fit = |garment: &str| {
        size(&verdict(&by_garment, garment, &[("cB", 190.0), ("cC", 400.0)]), "I", None).fit
    };
    assert_eq!((fit("AD"), fit("AG")), (Fit::Fits, Fit::DoesNotFit));
}

#[test]
fn without_an_uncertainty_the_value_alone_decides_and_it_is_said() {
    let garment = Garment::default();
    for (mm, fit) in [(180.0, Fit::Fits), (179.999, Fit::DoesNotFit), (200.0, Fit::Fits)] {
        let of = leg_verdict(&table(CALF), &garment, |point| match point {
            Point::Girth(Level::B) => given(mm, None),
            _ => given(310.0, Some(1.0)),
        });
        let of = of.unwrap();
        let one = size(&of, "I", None);
        assert_eq!(one.fit, fit, "{mm}");
        assert!(one.points[0].probability.is_none() && one.points[0].margins_mm.is_some());
    }
}

#[test]
fn a_value_inside_a_range_narrower_than_its_uncertainty_is_not_told_as_outside() {
    let narrow = table("[[size]]\nname = \"I\"\ncB = [19.9, 20.1]\n");
    let judge = |mm: f64| {
        let of = leg_verdict(&narrow, &Garment::default(), |_| given(mm, Some(40.0))).unwrap();
        (of.sizes[0].fit, of.sizes[0].points[0].probability.unwrap())
    };
    let (fit, share) = judge(200.0);
    assert!(share < 0.05 && fit == Fit::FitsWithinUncertainty, "{share}");
    assert_eq!(judge(300.0).0, Fit::DoesNotFit);
}

#[test]
fn under_tension_or_of_unknown_basis_nothing_is_compared() {
    let text = format!("{HEAD}{CALF}");
    let garment = Garment::default();
    let judge = |text: &str| {
        leg_verdict(&table_of(text), &garment, leg(&[("cB", 190.0), ("cC", 310.0)])).unwrap_err()
    };
    let basis = "skin_or_tension = \"skin\"\n";
    assert_eq!(
        judge(&text.replace(basis, "skin_or_tension = \"tension\"\n")),
        NotComparable::Tension
    );
    assert_eq!(judge(&text.replace(basis, "")), NotComparable::BasisUnknown);
    let other =
        text.replace("[[size]]\nname = \"I\"", "garments = [\"AG\"]\n[[size]]\nname = \"I\"");
    assert_eq!(judge(&other), NotComparable::OtherGarment);
    let foreign =
        format!("{HEAD}[[size]]\nname = \"I\"\ncG = [50, 60]\n").replace("\"cB\"", "\"cG\"");
    assert_eq!(judge(&foreign), NotComparable::OtherGarment);
}

#[test]
fn codes_are_those_of_the_garment_and_the_variant() {
    let coded = table(
        "[[variant]]\nname = \"wide\"\nreplaces = [\"cC\"]\n[[length]]\ngarment = \"AD\"\nname = \"short\"\n\
         lD = [30, 40]\n[[size]]\nname = \"I\"\ncB = [18, 20]\ncC = [28, 34]\ncode.AD.short = \"S\"\n\
         code.AG = \"G\"\nvariant.wide = { cC = [34, 40], code = \"W\" }\n",
    );
    let of = verdict(&coded, "AD", &[]);
    let codes = |variant: Option<&str>| {
        let of = size(&of, "I", variant).codes.iter();
        of.map(|of| (of.length.clone(), of.code.clone())).collect::<Vec<_>>()
    };
    assert_eq!(codes(None), [(Some("short".to_owned()), "S".to_owned())]);
    assert_eq!(codes(Some("wide")), [(None, "W".to_owned())]);
}
