// SPDX-License-Identifier: GPL-3.0-or-later
// A job type of Flamenco: a task for each input of a batch that `hybrid-mesh remesh INPUT... --output DIR --farm` has written, then one that merges their
// reports. It belongs into the folder `scripts` beside flamenco-manager.

const JOB_TYPE = {
    label: "Hybrid Mesh",
    description: "Remesh each input of a batch, then merge the reports",
    settings: [
        {
            key: "batch", type: "string", subtype: "file_path", required: true,
            description: "The batch.json that remesh --farm has written; outputs go into its folder",
        },
        {
            // The manager cannot read files, but Blender can, where the job is submitted.
            key: "names", type: "string", required: true, visible: "submission",
            eval: "'\\n'.join(__import__('json').loads(Path(abspath(settings.batch)).read_text(encoding='utf-8'))['names'])",
            evalInfo: { showLinkButton: true, description: "Read the names of the inputs from the batch" },
            description: "The name of each input, a line each",
        },
        {
            key: "launcher", type: "string", choices: ["blender --command", "blender --addons", "program"], default: "blender --command", visible: "submission",
            description: "How workers start Hybrid Mesh: Blender from 4.2 on, Blender before, or a program of its own",
        },
        {
            key: "program", type: "string", default: "{blender}", visible: "submission",
            description: "Blender, or the program that is started",
        },
        { key: "threads", type: "int32", default: 0, visible: "submission", description: "Threads a task; 0 is all of the worker's" },
    ],
};

const EXPRESSION = "from hybrid_mesh.core import cli; cli.main()";

const BEFORE = {
    "blender --command": ["--command", "hybrid_mesh"],
    "blender --addons": ["--background", "--python-exit-code", "1", "--addons", "hybrid_mesh", "--python-expr", EXPRESSION, "--"],
    "program": [],
};

function compileJob(job) {
    const settings = job.settings;
    const names = settings.names.split("\n").filter((name) => name.length > 0);
    if (names.length === 0) {
        throw new Error("the batch has no inputs: 'names' is empty");
    }
    const before = BEFORE[settings.launcher];
    if (!before) {
        throw new Error(`there is no launcher '${settings.launcher}'; there are ${Object.keys(BEFORE).join(", ")}`);
    }
    // Which workers a task may go to depends on what it runs.
    const type = settings.launcher === "program" ? "misc" : "blender";
    const threads = settings.threads ? ["--threads", String(settings.threads)] : [];

    function task(name, args) {
        const made = author.Task(name, type);
        made.addCommand(author.Command("exec", { exe: settings.program, args: [...before, ...args] }));
        return made;
    }

    const merge = task("merge reports", ["merge-reports", settings.batch]);
    names.forEach((name, place) => {
        const remesh = task(`remesh ${name}`, ["task", "--progress", "lines", ...threads, settings.batch, String(place + 1)]);
        job.addTask(remesh);
        merge.addDependency(remesh);
    });
    // After those that it waits for: the manager has to know a task before another one can depend on it.
    job.addTask(merge);
}
