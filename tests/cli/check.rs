//! `gaiter` as a program: what the command line and `check` end with, and what they print.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::{PermissionsExt, chown};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use rig::verb::{code, gaiter, stderr, stdout};
use tempfile::TempDir;

/// A configuration over folders in `root`, of which only the export folder exists.
fn station(root: &Path, more: &str) -> PathBuf {
    let at = root.display();
    fs::create_dir_all(root.join("export")).unwrap();
    let file = root.join("station.toml");
    let text = format!(
        "[station]\nid = \"t\"\nstate_dir = \"{at}/state\"\n[scanner]\nexport_dirs = [\"{at}/export\"]\n\
         max_scan = \"1MB\"\n{more}[store.folder]\npath = \"{at}/records\"\n"
    );
    fs::write(&file, text).unwrap();
    file
}

fn check(file: &Path, more: &[&str]) -> Output {
    gaiter(&[&["check", "--config", file.to_str().unwrap()], more].concat())
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn help_and_version_are_no_fault_and_go_to_standard_output() {
    for args in [["--help"].as_slice(), &["--version"], &["help"], &["extract", "--help"]] {
        let output = gaiter(args);
        assert_eq!(code(&output), Some(0), "{args:?}");
        assert!(stdout(&output).contains("gaiter") && output.stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn a_wrong_command_line_ends_with_64() {
    let wrong: [&[&str]; 6] = [
        &[],
        &["measure", "one", "two"],
        &["extract"],
        &["extract", "a.obj", "--unit", "ft"],
        &["extract", "a.obj", "--facing"],
        &["check", "--patient", "4711"],
    ];
    for args in wrong {
        let output = gaiter(args);
        assert_eq!(code(&output), Some(64), "{args:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn a_configuration_that_is_not_there_ends_with_66() {
    let root = TempDir::new().unwrap();
    let output = check(&root.path().join("none.toml"), &[]);
    assert_eq!(code(&output), Some(66));
    assert!(stderr(&output).contains("none.toml"), "{}", stderr(&output));
    let output = check(&root.path().join("none.toml"), &["--json"]);
    assert_eq!(code(&output), Some(66));
    assert_eq!(json(&output)["exit"], 66);
}

#[test]
fn a_configuration_that_cannot_be_read_ends_with_74() {
    let root = TempDir::new().unwrap();
    assert_eq!(code(&check(root.path(), &[])), Some(74), "a folder is no file");
}

#[test]
fn faults_of_the_configuration_end_with_78_and_are_told_with_the_name_of_the_file() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "quiet = \"2 sec\"\ncolour = 1\n");
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(78));
    assert!(output.stdout.is_empty());
    let said = stderr(&output);
    let first = format!("{}:7:9: scanner.quiet: \"2 sec\" is not a duration\n", file.display());
    assert!(said.starts_with(&first), "{said}");
    assert!(said.contains("  7 | quiet = \"2 sec\"\n    |         ^^^^^^^\n    hint: "), "{said}");
    assert!(said.ends_with("has 2 faults\n"), "{said}");

    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(78));
    let report = json(&output);
    assert_eq!(report["faults"].as_array().unwrap().len(), 2);
    assert_eq!(report["faults"][0]["key"], "scanner.quiet");
    assert_eq!(
        (&report["faults"][0]["line"], &report["faults"][0]["column"]),
        (&7.into(), &9.into())
    );
}

#[test]
fn a_sound_station_ends_with_0_and_the_check_leaves_nothing_behind() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(0), "{}{}", stdout(&output), stderr(&output));
    assert!(stdout(&output).contains("does not exist yet; can be made in"));
    let mut left: Vec<_> =
        fs::read_dir(root.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["export", "station.toml"]);

    private_folder(&root.path().join("state"));
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(0));
    let report = json(&output);
    let state =
        report["checks"].as_array().unwrap().iter().find(|row| row["check"] == "state folder");
    assert_eq!(state.unwrap()["detail"], "can be written, synced and renamed in");
    assert_eq!(fs::read_dir(root.path().join("state")).unwrap().count(), 0);
}

fn private_folder(folder: &Path) {
    fs::create_dir(folder).unwrap();
    fs::set_permissions(folder, fs::Permissions::from_mode(0o700)).unwrap();
}

#[test]
fn a_state_folder_in_which_others_have_rights_is_told() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let state = root.path().join("state");
    private_folder(&state);
    let row = || {
        let rows = json(&check(&file, &["--json"]))["checks"].as_array().unwrap().clone();
        rows.into_iter().find(|row| row["check"] == "state folder").unwrap()
    };
    assert_eq!(row()["verdict"], "ok");
    for mode in [0o777, 0o770, 0o755, 0o710] {
        fs::set_permissions(&state, fs::Permissions::from_mode(mode)).unwrap();
        let found = row();
        assert_eq!(found["verdict"], "warn", "{found}");
        let detail = found["detail"].as_str().unwrap();
        assert!(detail.contains(&format!("mode {mode:04o}")), "{detail}");
        assert!(detail.ends_with(&format!("chmod 700 {}", state.display())), "{detail}");
    }
    assert_eq!(fs::metadata(&state).unwrap().permissions().mode() & 0o777, 0o710);
}

#[test]
fn a_station_does_not_start_in_a_state_folder_of_another_user() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let state = root.path().join("state");
    private_folder(&state);
    // Only root can give a folder away.
    if chown(&state, Some(65_534), None).is_err() {
        return;
    }
    let output = gaiter(&["run", "--config", file.to_str().unwrap()]);
    assert_eq!(code(&output), Some(74));
    assert!(stderr(&output).contains("belongs to another user"), "{}", stderr(&output));
    assert_eq!(fs::read_dir(&state).unwrap().count(), 0);
}

#[test]
fn faults_of_the_environment_end_with_74_and_are_all_told() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    fs::remove_dir(root.path().join("export")).unwrap();
    fs::write(root.path().join("state"), "a file").unwrap();
    std::os::unix::fs::symlink("nowhere", root.path().join("records")).unwrap();
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(74));
    let report = json(&output);
    for check in ["export folder", "state folder", "record store"] {
        let rows = report["checks"].as_array().unwrap();
        let row = rows.iter().find(|row| row["check"] == check).unwrap();
        assert_eq!(row["verdict"], "fail", "{row}");
    }
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(74));
    assert!(stdout(&output).contains("is not a folder"), "{}", stdout(&output));
}

#[test]
fn a_link_from_one_folder_into_another_is_found() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    std::os::unix::fs::symlink("export", root.path().join("records")).unwrap();
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(74));
    assert!(stdout(&output).contains("folders apart"), "{}", stdout(&output));
}

#[test]
fn a_quiet_time_above_the_rescan_is_a_warning_and_no_fault() {
    let root = TempDir::new().unwrap();
    let output = check(&station(root.path(), "quiet = \"30s\"\n"), &[]);
    assert_eq!(code(&output), Some(0));
    assert!(stdout(&output).contains("warn  timing"), "{}", stdout(&output));
}

/// What `check` says of the file names `names` under the expression of the shipped file's example.
fn check_names(names: &[&str]) -> Output {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "file_name = '^(?<patient>P?[0-9]+)_'\n");
    names.iter().for_each(|name| fs::write(root.path().join("export").join(name), "x").unwrap());
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(0), "{}", stdout(&output));
    assert!(output.stderr.is_empty(), "ids go to standard output only: {}", stderr(&output));
    output
}

#[test]
fn names_that_would_take_a_date_for_a_person_are_a_warning_and_no_fault() {
    let said = stdout(&check_names(&["20261122_0915.obj", "20261122_0920.obj", "scan.obj"]));
    assert!(said.contains("3 names: 2 with a patient's id, 1 without, 0 with an id"), "{said}");
    assert!(said.contains("      20261122_0915.obj → 20261122\n"), "{said}");
    let warning = "every scan of 22 November 2026 would go to a patient 20261122";
    let warned = said.lines().find(|line| line.contains(warning)).unwrap();
    assert!(warned.starts_with("warn  file names") && warned.ends_with("[looks-like-a-date]"));
}

#[test]
fn names_that_would_take_a_counter_for_a_person_are_a_warning() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "file_name = '^(?<patient>P?[0-9]+)_'\n");
    // Their times say their order, whatever they are called.
    for (age, name) in [(3, "9_z.obj"), (2, "10_a.obj"), (1, "11_b.obj")] {
        let export = fs::File::create(root.path().join("export").join(name)).unwrap();
        let written = std::time::SystemTime::now() - std::time::Duration::from_secs(age * 60);
        export.set_modified(written).unwrap();
    }
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(0));
    let report = json(&output);
    let rows = report["checks"].as_array().unwrap().iter();
    let rows: Vec<_> = rows.filter(|row| row["check"] == "file names").collect();
    assert_eq!(rows[0]["examples"][0]["name"], "11_b.obj", "the newest first");
    assert_eq!(rows[0]["examples"][2]["patient"], "9");
    assert!(rows[1]["detail"].as_str().unwrap().contains("from 9 to 11"), "{}", rows[1]);
    assert_eq!(rows[1]["verdict"], "warn");
}

#[test]
fn names_that_name_patients_are_shown_without_a_warning() {
    let names = ["4711_left.obj", "P12_front.obj", "0815_20261122.obj", "1234567890123_a.obj"];
    let said = stdout(&check_names(&names));
    assert!(said.contains("4 names: 3 with a patient's id, 0 without, 1 with an id"), "{said}");
    for example in ["4711_left.obj → 4711", "P12_front.obj → P12", "0815_20261122.obj → 0815"]
    {
        assert!(said.contains(example), "{said}");
    }
    assert!(!said.contains("warn  file names"), "{said}");
}

#[test]
fn a_name_in_the_export_folder_cannot_forge_a_line_of_the_check() {
    let said = stdout(&check_names(&["4711_\u{1b}[2J\nfail  x.obj"]));
    assert!(said.contains(r"4711_\u{1b}[2J\nfail  x.obj → 4711"), "{said}");
}

#[test]
fn of_many_names_the_newest_are_looked_at() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "file_name = '^(?<patient>P?[0-9]+)_'\n");
    let old = fs::File::create(root.path().join("export/20261122_a.obj")).unwrap();
    old.set_modified(std::time::UNIX_EPOCH).unwrap();
    for n in 0..2000 {
        fs::write(root.path().join(format!("export/{}_a.obj", 7000 - 3 * n)), "").unwrap();
    }
    let said = stdout(&check(&file, &[]));
    assert!(said.contains("the newest 2000 of 2001 names: 2000 with a patient's id"), "{said}");
    assert_eq!(said.matches(" → ").count(), 5, "{said}");
    assert!(!said.contains("20261122"), "{said}");
}

#[test]
fn without_an_expression_one_line_says_that_file_names_identify_no_patient() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    fs::write(root.path().join("export/20261122_a.obj"), "").unwrap();
    let said = stdout(&check(&file, &[]));
    let lines: Vec<&str> = said.lines().filter(|line| line.contains("file name")).collect();
    let [line] = lines[..] else { panic!("{said}") };
    assert!(line.starts_with("ok    file names"), "{line}");
    assert!(line.ends_with("file names identify no patient"), "{line}");
    assert!(!said.contains("20261122"), "{said}");
}

#[test]
fn a_reader_that_has_gone_is_no_fault() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = Command::new(rig::verb::program())
        .args(["check", "--config"])
        .arg(&file)
        .stdout(writer)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(0));
}

#[test]
fn a_group_that_may_read_records_needs_a_folder_that_hands_itself_on() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let text = fs::read_to_string(&file).unwrap() + "mode = \"group\"\n";
    fs::write(&file, text).unwrap();
    let records = root.path().join("records");
    fs::create_dir(&records).unwrap();
    let row = |mode| {
        fs::set_permissions(&records, fs::Permissions::from_mode(mode)).unwrap();
        let report = json(&check(&file, &["--json"]));
        let rows = report["checks"].as_array().unwrap().clone();
        rows.into_iter().find(|row| row["check"] == "readers").unwrap()
    };
    let found = row(0o750);
    assert_eq!(found["verdict"], "warn", "{found}");
    assert!(found["detail"].as_str().unwrap().contains("chmod g+s"), "{found}");
    assert_eq!(row(0o2750)["verdict"], "ok");
}

#[test]
fn of_two_folders_of_records_one_may_keep_them_to_the_station() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let (records, copy) = (root.path().join("records"), root.path().join("copy"));
    let more = format!("mode = \"group\"\n[store.copy]\npath = \"{}\"\n", copy.display());
    fs::write(&file, fs::read_to_string(&file).unwrap() + &more).unwrap();
    let told = |mode: u32, copy_mode: u32| {
        for (folder, mode) in [(&records, mode), (&copy, copy_mode)] {
            fs::create_dir_all(folder).unwrap();
            fs::set_permissions(folder, fs::Permissions::from_mode(mode)).unwrap();
        }
        let report = json(&check(&file, &["--json"]));
        let rows = report["checks"].as_array().unwrap().clone();
        let rows = rows.into_iter().filter(|row| row["check"] == "readers");
        rows.map(|row| row["verdict"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(told(0o2750, 0o700), ["ok"]);
    assert_eq!(told(0o750, 0o2750), ["ok"]);
    assert_eq!(told(0o2750, 0o2750), ["ok", "ok"]);
    assert_eq!(told(0o750, 0o700), ["warn"]);
}

#[test]
fn a_button_that_is_not_there_and_an_address_that_is_taken_are_told_without_a_station() {
    let dir = TempDir::new().unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let more = format!(
        "[trigger.serial]\nport = \"{}/ttyBUTTON\"\ntokens = [\"PRESS\"]\n[status]\nlisten = \"{address}\"\n",
        dir.path().display()
    );
    let file = station(dir.path(), "");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, format!("{text}{more}")).unwrap();
    let rows = json(&check(&file, &["--json"]))["checks"].clone();
    let row = |of: &str| {
        let row = rows.as_array().unwrap().iter().find(|row| row["check"] == of).cloned();
        row.unwrap_or_else(|| panic!("no {of} in {rows}"))
    };
    let is = |row: serde_json::Value, verdict: &str, words: &str| {
        assert_eq!(row["verdict"], verdict, "{row}");
        assert!(row["detail"].as_str().unwrap().contains(words), "{row}");
    };
    is(row("port"), "warn", "is not there");
    is(row("address"), "warn", "ss -ltnp");
    drop(taken);
    fs::write(dir.path().join("ttyBUTTON"), "").unwrap();
    let rows = json(&check(&file, &["--json"]))["checks"].to_string();
    assert!(rows.contains("is there (trigger.serial.port)"), "{rows}");
    assert!(rows.contains("is free (status.listen)"), "{rows}");
}

/// The rows of a check by name and place, with verdict and detail.
fn rows(output: &Output, check: &str) -> Vec<(String, String, String)> {
    let text = |row: &serde_json::Value, key: &str| row[key].as_str().unwrap().to_owned();
    let report = json(output);
    let rows = report["checks"].as_array().unwrap().iter().filter(|row| row["check"] == check);
    rows.map(|row| (text(row, "place"), text(row, "verdict"), text(row, "detail"))).collect()
}

/// A port of this machine on which no one listens.
fn closed_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

#[test]
fn a_server_that_is_away_fails_and_its_secret_is_looked_at() {
    let root = TempDir::new().unwrap();
    let (secret, port) = (root.path().join("token"), closed_port());
    fs::write(&secret, "Quastenflosser\n").unwrap();
    let more = format!(
        "[store.fhir]\naddress = \"http://127.0.0.1:{port}/fhir\"\npatient_system = \"urn:house\"\n\
         access = \"bearer\"\nsecret = \"{}\"\n",
        secret.display()
    );
    let file = station(root.path(), &more);
    for (mode, verdict) in [(0o640, "warn"), (0o600, "ok")] {
        fs::set_permissions(&secret, fs::Permissions::from_mode(mode)).unwrap();
        let output = check(&file, &["--json"]);
        assert_eq!(code(&output), Some(74), "{}", stdout(&output));
        let [(place, found, _)] = &rows(&output, "secret")[..] else { panic!() };
        assert_eq!((Path::new(place), found.as_str()), (secret.as_path(), verdict));
        let [(place, found, detail)] = &rows(&output, "FHIR server")[..] else { panic!() };
        assert_eq!((place, found.as_str()), (&format!("http://127.0.0.1:{port}/fhir"), "fail"));
        assert!(detail.contains("refused"), "{detail}");
        assert!(!stdout(&output).contains("Quastenflosser"));
    }
    fs::remove_file(&secret).unwrap();
    let output = check(&file, &["--json"]);
    let [(_, found, detail)] = &rows(&output, "secret")[..] else { panic!() };
    assert_eq!(found, "fail");
    assert!(detail.contains("token: No such file"), "{detail}");
}

#[test]
fn an_archive_that_is_away_fails_and_whole_bodies_are_warned_of() {
    let root = TempDir::new().unwrap();
    let port = closed_port();
    let [key, site_key] = [("key", "word"), ("site", &*"0b".repeat(32))].map(|(name, text)| {
        let path = root.path().join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    });
    let more = format!(
        "[store.archive]\naddress = \"http://127.0.0.1:{port}\"\nbucket = \"chain\"\n\
         station = \"house-1\"\nkey_id = \"station\"\nkey = \"{key}\"\nsite_key = \"{site_key}\"\n\
         crop = \"whole\"\n"
    );
    let output = check(&station(root.path(), &more), &["--json"]);
    assert_eq!(code(&output), Some(74), "{}", stdout(&output));
    assert_eq!(rows(&output, "secret").len(), 2);
    let [(place, found, detail)] = &rows(&output, "archive")[..] else { panic!() };
    assert_eq!((place, found.as_str()), (&format!("http://127.0.0.1:{port}/chain"), "fail"));
    assert!(detail.contains("refused"), "{detail}");
    let [(_, found, _)] = &rows(&output, "crop")[..] else { panic!() };
    assert_eq!(found, "warn");
}

#[test]
fn a_credential_is_for_the_service_and_the_server_is_not_tried_without_it() {
    let root = TempDir::new().unwrap();
    let more = format!(
        "[store.fhir]\naddress = \"http://127.0.0.1:{}/fhir\"\npatient_system = \"urn:house\"\n\
         access = \"bearer\"\nsecret = \"credential:fhir\"\n",
        closed_port()
    );
    let file = station(root.path(), &more);
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(0), "{}", stdout(&output));
    for name in ["secret", "FHIR server"] {
        let [(_, verdict, _)] = &rows(&output, name)[..] else { panic!("{name}") };
        assert_eq!(verdict, "warn", "{name}");
    }
}

#[test]
#[cfg(feature = "dicom")]
fn a_line_that_anyone_can_read_is_told_with_what_is_read_and_whose_it_is() {
    let root = TempDir::new().unwrap();
    // An address that is kept for documents: nobody is there.
    let far = "address = \"192.0.2.1:104\"\nserver_ae_title = \"PACS\"\n\
               encryption = \"none\"\ntimeout = \"1s\"\n";
    for (section, read, server) in [
        ("store.dicom", "the results", "archive"),
        ("patient.worklist", "names and birth dates", "server of the worklist"),
    ] {
        let config = station(root.path(), &format!("[{section}]\n{far}"));
        let output = check(&config, &["--json"]);
        let [(_, verdict, detail)] = &rows(&output, "encryption")[..] else { panic!() };
        assert_eq!(verdict, "warn");
        let expected = format!(
            "not encrypted: anyone in the network can read {read}; encryption = \"tls\" if the \
             {server} can"
        );
        assert_eq!(*detail, expected);
    }
}

#[test]
fn a_receiver_takes_a_connection_or_fails_and_a_folder_of_messages_is_written_in() {
    let root = TempDir::new().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let store = |way: &str| format!("[store.hl7]\n{way}\n");
    let mllp = |port: u16| store(&format!("address = \"127.0.0.1:{port}\"\nencryption = \"none\""));
    let open = mllp(listener.local_addr().unwrap().port());
    for (way, exit, verdict) in [(open, 0, "ok"), (mllp(closed_port()), 74, "fail")] {
        let output = check(&station(root.path(), &way), &["--json"]);
        assert_eq!(code(&output), Some(exit), "{}", stdout(&output));
        let [(_, found, _)] = &rows(&output, "HL7 receiver")[..] else { panic!() };
        assert_eq!(found, verdict);
        assert!(rows(&output, "encryption").is_empty(), "it stays on this machine");
    }
    // An address that is kept for documents: nobody is there.
    let far = store("address = \"192.0.2.1:2575\"\nencryption = \"none\"\ntimeout = \"1s\"");
    let output = check(&station(root.path(), &far), &["--json"]);
    let [(_, verdict, detail)] = &rows(&output, "encryption")[..] else { panic!() };
    assert_eq!(verdict, "warn");
    let expected = "not encrypted: anyone in the network can read the results; \
                    encryption = \"tls\" if the receiver can";
    assert_eq!(detail, expected);
    let messages = root.path().join("messages");
    fs::create_dir(&messages).unwrap();
    let way = store(&format!("path = \"{}\"", messages.display()));
    let output = check(&station(root.path(), &way), &["--json"]);
    let [(place, verdict, _)] = &rows(&output, "message folder")[..] else { panic!() };
    assert_eq!((Path::new(place), verdict.as_str()), (messages.as_path(), "ok"));
    assert!(fs::read_dir(&messages).unwrap().next().is_none());
    let way = store(&format!("path = \"{}\"\ntimeout = \"1s\"", messages.display()));
    let output = check(&station(root.path(), &way), &["--json"]);
    assert_eq!(code(&output), Some(78), "files have no timeout: {}", stdout(&output));
}
