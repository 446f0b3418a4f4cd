//! Script of a Slurm job array: a task for each shard. Slurm schedules, repeats and limits the tasks.

use std::path::Path;

use super::single_run::quoted;

/// Text of the script for `sbatch`.
pub fn script(sweep: &Path, folder: &Path, shards: u32, csv: bool) -> String {
    let [sweep, folder] = [sweep, folder].map(|path| quoted(&path.display().to_string()));
    let csv = if csv { " --csv" } else { "" };
    format!(
        "#!/bin/sh
#SBATCH --job-name=arcfeed
#SBATCH --array=1-{shards}
#SBATCH --cpus-per-task=1
#SBATCH --requeue
# Submit:  sbatch --parsable THIS-SCRIPT
# Table:   sbatch --dependency=afterany:JOB --wrap \"arcfeed sweep {sweep} -o {folder} --merge{csv}\"
# A task that is started again goes on where it stopped.
exec arcfeed sweep {sweep} -o {folder} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\""
    )
}
