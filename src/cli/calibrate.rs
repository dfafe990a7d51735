//! `gaiter calibrate`: measures a scan of a body of known girths, and prints how far off scanner and method
//! are. Changes nothing.

use std::fmt::Write;
use std::io;

use gaiter_leg::Method;
use gaiter_leg::phantom::{self, Phantom};
use gaiter_record::phantom::{CheckFigures, CheckRecord, CheckResult};
use gaiter_record::sha256;
use jiff::Timestamp;

use super::args::CalibrateArgs;
use super::extract::scan_at;
use super::terminal::{self, painted};
use super::{Exit, complain, config_at, exit_of_printing, print, terminal_safe};

/// The tolerance without a configuration, mm: a tape reads to 1 to 2 mm.
const TOLERANCE_MM: f64 = 2.0;

/// Measures and prints. Returns [`Exit::Unmeasurable`] if the body cannot be measured, or if a girth is
/// beyond the tolerance.
pub fn calibrate(args: &CalibrateArgs) -> Result<Exit, Exit> {
    let choices = Choices::from_args(args)?;
    let check = checked(args, &choices).map_err(|(exit, why)| {
        complain(format_args!("gaiter: {}: {why}", terminal_safe(args.scan.display())));
        exit
    })?;
    let printed = match args.json {
        true => serde_json::to_string(&check)
            .map_err(io::Error::from)
            .and_then(|json| print(json + "\n")),
        false => terminal::print_painted(table(&check)),
    };
    let exit = match check.result {
        CheckResult::Within => Exit::Done,
        CheckResult::Beyond | CheckResult::NotMeasured => Exit::Unmeasurable,
    };
    Ok(exit.max(exit_of_printing("the check", printed)))
}

/// What is known of the body, and how it is measured.
struct Choices {
    phantom: Phantom,
    tolerance_mm: f64,
    method: Method,
}

impl Choices {
    /// The values of the configuration, or the defaults, overridden by the command line.
    fn from_args(args: &CalibrateArgs) -> Result<Choices, Exit> {
        let config = args.config.as_deref().map(config_at).transpose()?;
        let (mut method, configured) =
            config.map(|config| (config.method, config.phantom)).unwrap_or_default();
        method.unit = args.unit.unwrap_or(method.unit);
        method.up = args.up.unwrap_or(method.up);
        let tolerance_mm = configured.as_ref().map_or(TOLERANCE_MM, |phantom| phantom.tolerance_mm);
        let phantom = args.girths.clone().or(configured.map(|configured| configured.phantom));
        let Some(phantom) = phantom else {
            complain("gaiter: the configuration has no phantom.girths; name them with --girths");
            return Err(Exit::Usage);
        };
        Ok(Choices { phantom, tolerance_mm: args.tolerance.unwrap_or(tolerance_mm), method })
    }
}

fn checked(args: &CalibrateArgs, choices: &Choices) -> Result<CheckRecord, (Exit, String)> {
    let (bytes, format) =
        scan_at(&args.scan).map_err(|fault| (Exit::from(&fault), fault.to_string()))?;
    let found = phantom::check(&bytes, format, &choices.phantom, &choices.method);
    if let Err(fault) = &found
        && !args.json
    {
        let why = format!("cannot be measured [{}]: {fault}", fault.code());
        return Err((Exit::Unmeasurable, why));
    }
    Ok(CheckRecord::new(Timestamp::now(), sha256(&bytes), &found, choices.tolerance_mm))
}

/// The girths, what they show together, and the verdict.
fn table(check: &CheckRecord) -> String {
    let mut text = String::new();
    if let Some(figures) = &check.figures {
        let heading = "  height     known  measured  difference";
        let _ = writeln!(text, "{}", painted(terminal::LABEL, heading));
        for girth in &figures.girths {
            let (known, measured) = (girth.known_mm, girth.measured_mm);
            let height_cm = girth.height_mm / 10.0;
            let off = measured - known;
            let _ =
                writeln!(text, "{height_cm:5.1} cm  {known:8.1}  {measured:8.1}  {off:+7.1} mm");
        }
        text += &together(figures);
    }
    let tolerance_mm = check.tolerance_mm;
    let (colour, verdict) = match check.result {
        CheckResult::Within => (terminal::GOOD, format!("every girth is within {tolerance_mm} mm")),
        CheckResult::Beyond => (
            terminal::BAD,
            format!("not every girth is within {tolerance_mm} mm: have the scanner calibrated"),
        ),
        CheckResult::NotMeasured => (terminal::BAD, "not measured".to_owned()),
    };
    text + &painted(colour, verdict) + "\n"
}

fn together(figures: &CheckFigures) -> String {
    let CheckFigures { bias_mm, worst_mm, tilt_deg, .. } = figures;
    let mut text = format!(
        "\nbias {bias_mm:+.1} mm, worst {worst_mm:+.1} mm; the body leans by {tilt_deg:.1}°\n"
    );
    if let Some(line) = figures.line {
        let (scale, scale_sd) = (100.0 * line.scale, 100.0 * line.scale_sd);
        let (offset_mm, sd_mm) = (line.offset_mm, line.offset_sd_mm);
        let _ = writeln!(
            text,
            "scale {scale:+.2} % ± {scale_sd:.2}, and {offset_mm:+.1} mm ± {sd_mm:.1} at every girth"
        );
    }
    text
}
