//! Slurm: an array script, a script that merges, and one that submits both.

use super::{Files, Job, line, quoted};

/// Times that a part may be put back into the queue.
const TURNS: u32 = 1000;

pub(super) fn files(job: &Job) -> Files {
    let Job {
        name,
        parts,
        cpus,
        folder,
        here,
        ..
    } = job;
    let last = parts - 1;
    let with_program = |arguments: Vec<String>| {
        let mut words = vec![job.gonio.clone()];
        words.extend(arguments);
        line(&words)
    };
    let render = with_program(job.render("auto", None));
    let merge = with_program(job.merge());
    let (quoted_here, quoted_folder) = (quoted(here), quoted(folder));
    // Slurm reads its lines itself: a path with a blank is quoted there as well.
    let log = quoted(&format!("{folder}/%x-%a.log"));
    let render = format!(
        "#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task={cpus}
#SBATCH --output={log}
#SBATCH --open-mode=append
#SBATCH --requeue
# Two minutes before its time is up a part is told to keep its samples.
#SBATCH --signal=B:TERM@120

cd {quoted_here} || exit 3
{render} &
part=$!
trap 'kill -TERM \"$part\" 2>/dev/null' TERM INT
# A signal ends the waiting, not the part.
while :; do
    wait \"$part\"
    status=$?
    [ \"$status\" -gt 128 ] && kill -0 \"$part\" 2>/dev/null || break
done
# Interrupted, with its samples kept, or killed: it goes on in the next turn.
if [ \"$status\" -eq 4 ] || [ \"$status\" -gt 128 ] && [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {TURNS} ]; then
    scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"
fi
exit \"$status\"
"
    );
    let log = quoted(&format!("{folder}/{name}-merge.log"));
    let merge = format!(
        "#!/bin/sh
#SBATCH --job-name={name}-merge
#SBATCH --cpus-per-task=1
#SBATCH --output={log}
#SBATCH --open-mode=append

cd {quoted_here} || exit 3
exec {merge}
"
    );
    let submit = format!(
        "#!/bin/sh
# Submits the parts, and the merge once all of them are done. Arguments go to both: sh submit.sh --partition=long
set -e
cd {quoted_folder}
job=$(sbatch --parsable \"$@\" render.sbatch)
job=${{job%%;*}}
echo \"parts: $job\"
echo \"merge: $(sbatch --parsable --dependency=afterok:\"$job\" \"$@\" merge.sbatch)\"
"
    );
    (
        vec![
            ("render.sbatch", render),
            ("merge.sbatch", merge),
            ("submit.sh", submit),
        ],
        format!("sh {}", quoted(&format!("{folder}/submit.sh"))),
    )
}
