//! `sweep --slurm` on a real Slurm of one node, which the test starts: `munged`, `slurmctld` and `slurmd` with a folder, keys and
//! ports of their own, as the user who runs the test.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use arcfeed_tests::{Scratch, arcfeed, root, run, skip_loudly};

/// Programs of Slurm that the test runs.
const PROGRAMS: [&str; 6] = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol"];
/// Folder of servers, which is not in every user's path.
const SERVERS: &str = "/usr/sbin";
/// Longest wait for a state.
const WAIT_MAX: Duration = Duration::from_secs(180);
/// Task that is killed, of as many.
const KILLED: (u32, u32) = (2, 4);
/// Runs of the campaign.
const RUNS: usize = 240;
/// Runs of the task after which it is killed.
const RUNS_BEFORE: usize = 5;

/// Slurm of one node; its servers end with the value.
struct Slurm {
    config: String,
    path: String,
    servers: Vec<Child>,
}

impl Slurm {
    /// Starts the servers, and waits until the node is idle.
    fn start(scratch: &Scratch) -> Self {
        let [control, node] = free_ports();
        let [host, user] =
            [("hostname", "-s"), ("id", "-un")].map(|(program, word)| printed(Command::new(program).arg(word)));
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let at = |name: &str| scratch.path(name);
        let [state, spool, socket, key] = ["state", "spool", "munge.socket", "munge.key"].map(at);
        for folder in [&state, &spool] {
            fs::create_dir(folder).expect("a folder");
        }
        let settings = format!(
            "ClusterName=test\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort={control}\nSlurmdPort={node}\n\
             AuthType=auth/munge\nAuthInfo=socket={socket}\nCredType=cred/munge\nSlurmUser={user}\nSlurmdUser={user}\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\n\
             SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n\
             StateSaveLocation={state}\nSlurmdSpoolDir={spool}\nSlurmctldPidFile={}\nSlurmdPidFile={}\n\
             ReturnToService=2\nAccountingStorageType=accounting_storage/none\nJobAcctGatherType=jobacct_gather/none\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN\nPartitionName=main Nodes=ALL Default=YES State=UP\n",
            at("slurmctld.pid"),
            at("slurmd.pid")
        );
        let config = scratch.write("slurm.conf", settings);
        scratch.write("cgroup.conf", "");
        write_key(&key);
        let path = std::env::var("PATH").unwrap_or_default();
        let programs = arcfeed().parent().expect("a folder").display().to_string();
        let mut slurm = Slurm { config, path: format!("{programs}:{path}:{SERVERS}"), servers: Vec::new() };
        let files = ["pid", "log", "seed"].map(|kind| format!("--{kind}-file={}", at(&format!("munged.{kind}"))));
        let of_munge = [format!("--key-file={key}"), format!("--socket={socket}")];
        let of_munge: Vec<&str> = of_munge.iter().chain(&files).map(String::as_str).collect();
        slurm.serve("munged", &[&["--foreground", "--force"], &of_munge[..]].concat());
        until("munge", || Path::new(&socket).exists());
        slurm.serve("slurmctld", &["-D", "-L", &at("slurmctld.log")]);
        slurm.serve("slurmd", &["-D", "-L", &at("slurmd.log")]);
        until("the node", || slurm.ask("sinfo", &["-h", "-o", "%T"]) == "idle");
        slurm
    }

    fn serve(&mut self, name: &str, arguments: &[&str]) {
        let mut command = self.command(name, arguments);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a server starts");
        self.servers.push(child);
    }

    /// Output of a program of Slurm, or nothing if it fails.
    fn ask(&self, name: &str, arguments: &[&str]) -> String {
        printed(self.command(name, arguments).stderr(Stdio::null()))
    }

    fn command(&self, name: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(find(name).expect("it was there"));
        command.args(arguments).env("SLURM_CONF", &self.config).env("PATH", &self.path);
        command
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        for server in self.servers.iter_mut().rev() {
            let _gone_already = server.kill().and_then(|()| server.wait());
        }
    }
}

#[test]
fn a_job_array_of_a_real_slurm_has_the_rows_of_one_computer_although_a_task_is_killed() {
    let missing: Vec<&str> = PROGRAMS.into_iter().filter(|program| find(program).is_none()).collect();
    if !missing.is_empty() {
        let why =
            format!("{} of Slurm missing (Debian's slurm-wlm; `cargo xtask test` installs it)", missing.join(", "));
        assert!(std::env::var_os("CI").is_none(), "{why}");
        return skip_loudly("slurm", &why);
    }
    let scratch = Scratch::new("slurm");
    let sweep = scratch.write("SWEEP.toml", sweep_text());
    let (folder, whole) = (scratch.path("out"), scratch.path("whole"));
    let slurm = Slurm::start(&scratch);
    let (task, tasks) = KILLED;
    let script = run(&["sweep", &sweep, "-o", &folder, "--slurm", &tasks.to_string()]).stdout;
    let script = scratch.write("campaign.sh", script);
    let job = slurm.ask("sbatch", &["--parsable", "--output=/dev/null", &script]);
    let journal = format!("{folder}/shard-{task}-of-{tasks}.journal");
    until("the task", || lines(&journal) > RUNS_BEFORE);
    let process = process_of(&folder, &format!("{task}/{tasks}")).expect("the task runs");
    let killed = Command::new("kill").args(["-9", &process]).status();
    assert!(killed.is_ok_and(|status| status.success()));
    let task = format!("{job}_{task}");
    until("the end of the task", || slurm.ask("squeue", &["-h", "-t", "all", "-j", &task, "-o", "%T"]) == "FAILED");
    let before = lines(&journal);
    assert!(before < RUNS / tasks as usize, "the task had ended before it was killed");
    // Slurm would wait two minutes with the task, and with it all that depends on it.
    for words in [vec!["requeue", &task], vec!["update", &format!("jobid={task}"), "StartTime=now"]] {
        assert!(slurm.command("scontrol", &words).status().is_ok_and(|status| status.success()), "{words:?}");
    }
    let merge = format!("arcfeed sweep {sweep} -o {folder} --merge --csv");
    let after = format!("--dependency=afterany:{job}");
    slurm.ask("sbatch", &["--parsable", "--output=/dev/null", &after, "--wrap", &merge]);
    until("the campaign", || slurm.ask("squeue", &["-h"]).is_empty());
    assert!(run(&["sweep", &sweep, "-o", &whole, "--csv"]).status.success());
    let table = |folder: &str| fs::read_to_string(format!("{folder}/runs/part-00001.csv")).expect("a table");
    assert_eq!(table(&folder), table(&whole));
    let runs: usize = (1..=tasks).map(|task| lines(&format!("{folder}/shard-{task}-of-{tasks}.journal"))).sum();
    println!("{tasks} tasks of Slurm, one killed after {before} runs: {runs} runs made for {RUNS} rows");
    assert_eq!(runs, RUNS, "a run was lost or made twice");
}

/// Bit errors on the line to the control, drawn feeds: some runs end in alarms.
fn sweep_text() -> String {
    format!(
        "job = {:?}\ncommand = \"stream\"\nport = \"fault://tx.flip={{flip}},seed={{seed}}/sim:\"\naccept = [\"passed\", \"stopped\"]\n\
         figures = [\"cycle_time_s\", \"alarms\", \"link.bytes\", \"chip_load.error_ratio_max\"]\n\
         [grid]\ndnc.code = [\"iso\"]\nflip = [0.0, 0.0005]\nseed = {{ from = 1, to = {} }}\n\
         [random]\nruns = 2\nlaw.feed_per_tooth = {{ from = 0.08, to = 0.1 }}\n",
        root().join("examples/pocket/job-contour.toml").display().to_string(),
        RUNS / 4
    )
}

/// Runs in a journal, below its first line.
fn lines(journal: &str) -> usize {
    fs::read_to_string(journal).map_or(0, |text| text.lines().count().saturating_sub(1))
}

/// Process whose command line has both words.
fn process_of(folder: &str, shard: &str) -> Option<String> {
    let processes = fs::read_dir("/proc").expect("Linux").flatten();
    let has_both = |path: &PathBuf| {
        let words = fs::read(path.join("cmdline")).unwrap_or_default();
        let words: Vec<&[u8]> = words.split(|byte| *byte == 0).collect();
        words.contains(&folder.as_bytes()) && words.contains(&shard.as_bytes())
    };
    let path = processes.map(|process| process.path()).find(has_both)?;
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}

/// Place of a program.
fn find(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain([SERVERS.into()]);
    folders.map(|folder| folder.join(program)).find(|path| path.exists())
}

/// Two ports that no program listens on.
fn free_ports() -> [u16; 2] {
    let listeners = [0; 2].map(|port| TcpListener::bind(("127.0.0.1", port)).expect("a port"));
    listeners.map(|listener| listener.local_addr().expect("an address").port())
}

/// Key of munge, which only its owner may read.
fn write_key(path: &str) {
    use std::os::unix::fs::PermissionsExt;
    let random = fs::read("/proc/sys/kernel/random/uuid").expect("Linux");
    fs::write(path, random.repeat(4)).expect("a key");
    fs::set_permissions(path, fs::Permissions::from_mode(0o600)).expect("its permissions");
}

/// First line that a program prints.
fn printed(command: &mut Command) -> String {
    let output = command.output().expect("a program of the system");
    String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().trim().to_owned()
}

/// Waits for a state.
fn until(what: &str, holds: impl Fn() -> bool) {
    let started = Instant::now();
    while !holds() {
        assert!(started.elapsed() < WAIT_MAX, "{what}: not ready in time");
        sleep(Duration::from_millis(5));
    }
}
