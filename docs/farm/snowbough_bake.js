// SPDX-License-Identifier: GPL-3.0-or-later

// A job type for Flamenco 3: bakes snow on several machines at once, then renders.
// Put this file into the Manager's `scripts` folder and restart the Manager.
//
// One bake task per set of receivers (every task sees all objects as occluders, so the maps are the
// same bytes whichever machine made them), then render chunks that wait for all of the bakes.
// A bake task that is run again goes on from its last checkpoint.

const JOB_TYPE = {
    label: "Snowbough Bake and Render",
    description: "Bake snow, one task per set of receivers, then render the frames",
    settings: [
        { key: "frames", type: "string", required: true,
          eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          description: "Frame range to render, such as '1-48'" },
        { key: "bake_frames", type: "string", required: true,
          eval: "f'{C.scene.snowbough.frame_start}-{C.scene.snowbough.frame_end}'",
          description: "Frame range to bake; it begins with the shot's first frame" },
        { key: "chunk_size", type: "int32", default: 4, propargs: {min: 1}, visible: "submission",
          description: "Number of frames in one render task" },
        { key: "receiver_sets", type: "string", required: true,
          eval: "'; '.join(sorted(r.object.name for r in C.scene.snowbough.receivers if r.object and r.enabled))",
          description: "Receivers to bake: names in one task separated by ',', tasks separated by ';'" },
        { key: "cache", type: "string", subtype: "dir_path", required: true,
          eval: "str(Path(abspath(C.scene.snowbough.cache_directory)))",
          description: "Cache folder on storage that all workers share" },
        { key: "cli", type: "string", subtype: "file_path", required: true,
          description: "The add-on's cli.py as the workers see it" },
        { key: "attempts", type: "int32", default: 30, propargs: {min: 1}, visible: "submission",
          description: "Attempts, one per minute, while another bake holds the cache, or the disk is full or unreachable" },
        { key: "render_output", type: "string", subtype: "file_path", required: true,
          eval: "abspath(C.scene.render.filepath) + '######'",
          description: "Path of the rendered frames" },

        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "Path of the .blend" },
        { key: "format", type: "string", required: true, visible: "web",
          eval: "C.scene.render.image_settings.file_format" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    const bakes = receiverSets(settings.receiver_sets).map(set => bakeTask(settings, set));
    for (const bake of bakes) {
        job.addTask(bake);
    }
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const render = renderTask(settings, chunk);
        for (const bake of bakes) {
            render.addDependency(bake);
        }
        job.addTask(render);
    }
}

// "A, B; C" -> ["A,B", "C"]
function receiverSets(text) {
    const sets = text.split(";")
        .map(set => set.split(",").map(name => name.trim()).filter(name => name).join(","))
        .filter(set => set);
    if (sets.length === 0) {
        throw "no receivers: name at least one in receiver_sets";
    }
    return sets;
}

function blenderCommand(settings, args) {
    return author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: settings.blendfile,
        args: args,
    });
}

function bakeTask(settings, set) {
    const task = author.Task(`snow-${set}`, "blender");
    task.addCommand(blenderCommand(settings, [
        "--python-exit-code", "1",
        "-P", settings.cli,
        "--", "bake",
        "--frames", settings.bake_frames,
        "--cache", settings.cache,
        "--objects", set,
        "--resume",
        "--attempts", String(settings.attempts),
    ]));
    return task;
}

function renderTask(settings, chunk) {
    const task = author.Task(`render-${chunk}`, "blender");
    task.addCommand(blenderCommand(settings, [
        "--render-output", settings.render_output,
        "--render-format", settings.format,
        "--render-frame", chunk.replace("-", ".."),
    ]));
    return task;
}
