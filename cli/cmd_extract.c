#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "cli/report.h"
#include "cli/surface.h"
#include "core/status.h"

#include <string.h>
#include <sys/stat.h>

typedef struct extract_args {
    cli_common common;
    cli_input input;
    const char *output, *name, *format, *json;
    cli_number iso, snap;
    int inside, normals, progress, topology;
    bool open, no_clobber, local, check;
    size_t max_triangles;
} extract_args;

static const extract_args defaults = {.check = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE", "the mesh: .glb, .gltf, .stl, .ply or .obj",
     offsetof(extract_args, output)},
    {"iso", 'i', CLI_NUMBER, "V", "the isovalue, in the unit of the values (required)",
     offsetof(extract_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "which values are inside the solid (above)",
     offsetof(extract_args, inside)},
    {"open", 0, CLI_FLAG, NULL, "leave the surface open where the volume ends (closed)",
     offsetof(extract_args, open)},
    {"topology", 0, CLI_CHOICE, "field/simple",
     "in ambiguous cells: the trilinear field's, or one table's (field)",
     offsetof(extract_args, topology)},
    {"snap", 0, CLI_NUMBER, "SHARE",
     "merge crossings within this share of an edge from one sample, to 0.5; try 0.3 (off)",
     offsetof(extract_args, snap)},
    {"normals", 0, CLI_CHOICE, "field/none", "normals from the field's gradient (field)",
     offsetof(extract_args, normals)},
    {"name", 0, CLI_TEXT, "TEXT", "of the object inside the file (the output's stem)",
     offsetof(extract_args, name)},
    {"format", 0, CLI_TEXT, "NAME", "write this format of 'formats' (by extension)",
     offsetof(extract_args, format)},
    {"no-clobber", 0, CLI_FLAG, NULL, "fail when the output exists (replace it)",
     offsetof(extract_args, no_clobber)},
    {"local", 0, CLI_FLAG, NULL,
     "coordinates relative to the mesh's origin, which is printed (the world's)",
     offsetof(extract_args, local)},
    {"check", 0, CLI_FLAG, NULL, "measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(extract_args, check)},
    {"max-triangles", 0, CLI_COUNT, "N", "stop before making more, e.g. 100M (no limit)",
     offsetof(extract_args, max_triangles)},
    {"json", 0, CLI_TEXT, "FILE", "write a report; - is the standard output",
     offsetof(extract_args, json)},
    {"progress", 0, CLI_CHOICE, "auto/plain/json/none", "how to show it, on stderr (auto)",
     offsetof(extract_args, progress)},
    CLI_INPUT_OPTIONS(extract_args),
};

typedef struct run_state {
    const extract_args *args;
    cli_volume volume;
    cw_mesh mesh;
    cw_extract_counts counts;
    cw_quality quality;
    cli_report report;
    double start;
} run_state;

static void put_params(cli_json *j, const void *p)
{
    const extract_args *args = p;
    cli_json_number(j, "iso", args->iso.value);
    cli_json_text(j, "inside", args->inside ? "below" : "above");
    cli_json_bool(j, "open", args->open);
    cli_json_text(j, "topology", args->topology ? "simple" : "field");
    cli_json_number(j, "snap", args->snap.value);
    cli_json_text(j, "normals", args->normals ? "none" : "field");
    cli_json_count(j, "component", args->input.component);
    cli_json_count(j, "step", args->input.step);
}

/* Everything about the arguments that can be refused before the input is touched. The report is
 * an output too: until it is known not to be the input, none is written. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    const char *const *inputs = args->common.inputs;
    cw_status st = args->json ? cli_check_output(args->json, inputs, 1, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    if (!args->output)
        return cw_fail(err, CW_ERR_ARGUMENT, "extract needs an output: -o FILE");
    if (!args->iso.given)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "extract needs a level: --iso V; 'cubewright info %s' suggests some",
                       inputs[0]);
    if (!(args->snap.value >= 0 && args->snap.value <= CW_EXTRACT_MAX_SNAP))
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--snap is a share of an edge, 0 to %g, and not %g", CW_EXTRACT_MAX_SNAP,
                       args->snap.value);
    st = cli_check_output(args->output, inputs, 1, err);
    if (st != CW_OK)
        return st;
    return cw_mesh_write_check(
        args->output, &(cw_write_desc){.format = args->format, .no_clobber = args->no_clobber},
        err);
}

static cw_status extract(run_state *s, cw_error *err)
{
    const cw_volume *v = &s->volume.view;
    const cw_extract_desc desc = {
        .isovalue = s->args->iso.value,
        .inside_is_low = s->args->inside,
        .leave_open = s->args->open,
        .simple_topology = s->args->topology,
        .snap = s->args->snap.value,
        .no_normals = s->args->normals,
        .threads = (int)s->args->input.threads,
        .max_triangles = s->args->max_triangles,
    };
    cli_report_begin(&s->report);
    cw_status st = cli_extract_surface(&s->volume, &desc, &s->mesh, &s->counts, err);
    if (st == CW_OK && desc.snap > 0)
        s->report.snap = &s->counts.snap;
    if (st == CW_OK)
        cli_report_end(&s->report, "extract", v->dim[0] * v->dim[1] * v->dim[2],
                       s->mesh.triangle_count);
    return st;
}

/* The promise: closed unless --open, and a manifold without zero-area triangles in any case. */
static cw_status check(run_state *s, cw_error *err)
{
    cw_quality *q = &s->quality;
    cli_report_begin(&s->report);
    cw_status st = cw_quality_measure(&s->mesh, NULL, q, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->report, "check", s->mesh.triangle_count, s->mesh.triangle_count);
    s->report.quality = q;
    if (q->nonmanifold_edges || q->nonmanifold_vertices || q->misoriented_edges ||
        q->degenerate || (q->open_edges && !s->args->open))
        return cw_fail(
            err, CW_ERR_CHECK,
            "%s: the surface at %g is not as promised: %zu open, %zu non-manifold, %zu "
            "misoriented edges, %zu non-manifold vertices, %zu degenerate triangles; "
            "nothing is written (--no-check writes it)",
            s->volume.path, s->args->iso.value, q->open_edges, q->nonmanifold_edges,
            q->misoriented_edges, q->nonmanifold_vertices, q->degenerate);
    return CW_OK;
}

static void warn_of_loss(run_state *s, const cw_write_loss *loss)
{
    if (loss->merged_vertices || loss->flat_triangles)
        cli_report_warn(
            &s->report,
            "%s: so far from zero single precision has steps of %.3g mm: %s of %s vertices "
            "fall together, %s of %s triangles lose their area; --local or .glb keeps them",
            cli_shown_path(s->args->output), loss->step_mm, cli_count(loss->merged_vertices),
            cli_count(s->mesh.vertex_count), cli_count(loss->flat_triangles),
            cli_count(s->mesh.triangle_count));
}

static cw_status write_mesh(run_state *s, cw_error *err)
{
    const cw_write_desc desc = {
        .format = s->args->format,
        .name = s->args->name,
        .no_clobber = s->args->no_clobber,
        .local = s->args->local,
        .progress = cli_progress((double)s->mesh.triangle_count / 1e6, "Mtriangle"),
    };
    cw_write_loss loss;
    cli_report_begin(&s->report);
    cw_status st = cw_mesh_write_loss(s->args->output, &s->mesh, &desc, &loss, err);
    if (st == CW_OK)
        st = cw_mesh_write(s->args->output, &s->mesh, &desc, err);
    if (st == CW_OK) {
        s->report.output = s->args->output;
        s->report.local_origin = desc.local ? s->mesh.origin : NULL;
        warn_of_loss(s, &loss);
        cli_report_end(&s->report, "write", s->mesh.triangle_count, s->mesh.triangle_count);
    }
    return st;
}

static void print_topology(const run_state *s)
{
    const cw_quality *q = &s->quality;
    if (s->args->open)
        cli_result("; manifold, %s", q->open_edges ? "open at the volume's border" : "closed");
    else if (s->counts.border_loops)
        cli_result("; closed (%s %s at the volume's border capped), manifold",
                   cli_count(s->counts.border_loops),
                   s->counts.border_loops == 1 ? "loop" : "loops");
    else
        cli_result("; closed, manifold");
    cli_result("; %s %s; box %.6g x %.6g x %.6g mm", cli_count(q->components),
               q->components == 1 ? "component" : "components", q->max[0] - q->min[0],
               q->max[1] - q->min[1], q->max[2] - q->min[2]);
}

static void print_summary(const run_state *s)
{
    struct stat info = {0};
    stat(s->args->output, &info);
    cli_result("%s: %s vertices, %s triangles, %s", s->args->output,
               cli_count(s->mesh.vertex_count), cli_count(s->mesh.triangle_count),
               cli_bytes((double)info.st_size));
    if (s->args->check)
        print_topology(s);
    if (s->report.snap)
        cli_result("; %s vertices merged, off by at most %.3g mm, %.2g voxels",
                   cli_count(s->counts.snap.vertices), s->counts.snap.max_error_mm,
                   s->counts.snap.max_error_voxels);
    if (s->args->local)
        cli_result("; relative to %.15g, %.15g, %.15g mm", s->mesh.origin[0], s->mesh.origin[1],
                   s->mesh.origin[2]);
    cli_result("; %.2f s\n", cli_seconds() - s->start);
}

static cw_status pipeline(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    cw_status st = check_args(s, err);
    if (st != CW_OK)
        return st;
    cli_report_begin(&s->report);
    st = cli_read_volume(args->common.inputs[0], &args->input, false, &s->volume, err);
    if (st != CW_OK)
        return st;
    const cw_volume *v = &s->volume.view;
    s->report.input = &s->volume;
    cli_report_end(&s->report, "read", 1, v->dim[0] * v->dim[1] * v->dim[2]);
    for (int r = 0; r < 3; r++)
        cli_say_vv("affine   %12.6g %12.6g %12.6g %12.6g", v->affine[r][0], v->affine[r][1],
                   v->affine[r][2], v->affine[r][3]);
    st = extract(s, err);
    if (st == CW_OK && args->check)
        st = check(s, err);
    if (st == CW_OK)
        st = write_mesh(s, err);
    return st;
}

static cw_status run(void *p, cw_error *err)
{
    const extract_args *args = p;
    run_state s = {.args = args, .start = cli_seconds()};
    s.report = (cli_report){.command = "extract", .params = put_params, .args = args};
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    if (args->json && strcmp(args->json, "-") == 0)
        cli_results_to_stderr();
    cw_status st = pipeline(&s, err);
    if (st == CW_OK)
        print_summary(&s);
    st = cli_report_write(&s.report, st, err);
    cw_mesh_free(&s.mesh);
    cw_volume_free(&s.volume.whole);
    return st;
}

const cli_command cli_extract = {
    .name = "extract",
    .usage = "VOLUME --iso V -o MESH [options]",
    .about = "a volume to a mesh: the surface where the values equal an isovalue",
    .more =
        "Reads a volume, extracts the surface of its trilinear field at the isovalue, checks "
        "that\n"
        "the surface is closed and a manifold, and writes it. Values at or above the isovalue "
        "are\n"
        "inside. Where the solid meets the volume's border it is closed by a flat cap.\n"
        "Nothing is smoothed, reduced or dropped. The same bytes for any number of threads.\n\n"
        "With --snap crossings close to one sample become one vertex, and the needles between\n"
        "them go: 0.3 leaves few angles below 10 degrees, 0.5 few below 20. What is not proven "
        "to\n"
        "keep the topology and to cross nothing stays. The error is printed, and in the "
        "report.\n\n"
        "STL, PLY and OBJ hold world coordinates; far from the world's zero single precision\n"
        "loses them, and extract warns. With --local they are relative to the mesh's origin:\n"
        "add it to get the world's. It is printed, and named in the report and in the file.\n"
        "In GLB and glTF, which lose nothing, --local leaves out the node's translation.\n\n"
        "Examples\n"
        "  cubewright extract head.nii.gz --iso 50 -o head.glb\n"
        "  cubewright extract ct.nrrd --iso 300 -o bone.stl --json report.json\n"
        "  cubewright extract slab.raw --raw dims=512x512x300,type=u16le --spacing 0.5mm \\\n"
        "      --iso 1200 -o part.ply\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(extract_args),
    .defaults = &defaults,
    .run = run,
};
