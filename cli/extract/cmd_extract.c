/* The command extract: its options, and the run over the steps of a series and their levels
 * up to the written files. */
#include "cli/extract/extract_run.h"
#include "cli/extract/label_run.h"
#include "cli/extract/part_run.h"
#include "cli/extract/pvd_list.h"
#include "cli/extract/stream_run.h"
#include "cli/framework/batch.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/inputs/level_choice.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/status.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <stdint.h>
#include <string.h>

enum { DEFAULT_FPS = 10 };

static const cli_extract_args defaults = {.compress.kind = -1,
                                          .texture = CLI_TEXTURE_DEFAULTS,

                                          .check = true,
                                          .measure = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; - is the standard output (with --format); may "
     "hold {level}, {step}, {stem}, {parent}, of "
     "--lod {lod}, and of labels {label} and {name}",
     offsetof(cli_extract_args, output), CLI_VALUES_MESH_OUTPUT},
    {"iso", 'i', CLI_LEVELS, "V[,V...]",
     "Isovalue, or several: numbers, 40% (of the range), otsu, dark, medium, bright, half; of a CT "
     "bone, skin, soft, lung, metal (required; in level sets 0)",
     offsetof(cli_extract_args, iso)},
    {"labels", 'l', CLI_TEXT, "all/LIST",
     "Extract labels of a label map instead: all, or a list such as 1,5,7-9,Liver (none)",
     offsetof(cli_extract_args, labels)},
    CLI_HEADED("Labels"),
    {"probabilities", 0, CLI_TEXT, "first/rest/V",
     "Inputs hold a field a label: the largest is there. The background is the first one, 1 minus "
     "their sum, or below a value such as 0.5 (off)",
     offsetof(cli_extract_args, probabilities)},
    {"names", 0, CLI_TEXT, "FILE",
     "Table of the labels' names and colours (in the volume, else in a file beside it)",
     offsetof(cli_extract_args, names), CLI_VALUES_FILE},
    {"require-labels", 0, CLI_FLAG, NULL,
     "Fail if a label of the list has no voxels (off: it is skipped)",
     offsetof(cli_extract_args, require_labels)},
    {"smooth-labels", 0, CLI_VOXEL_LENGTH, "off/L",
     "Limit of smoothing along each axis: 0.3mm, or up to half a voxel (0.5vox)",
     offsetof(cli_extract_args, smooth_labels)},
    {"round", 0, CLI_FLAG, NULL,
     "Take values with noise as the nearest whole numbers, and say how many (off: an error)",
     CLI_INPUT_ROW(cli_extract_args, round_labels)},
    {"shared-faces", 0, CLI_FLAG, NULL,
     "Write the interface of two labels once, for VTP, PLY, glTF and OBJ (off: with each)",
     offsetof(cli_extract_args, shared_faces)},
    {"per-label", 0, CLI_FLAG, NULL,
     "Simplify each label by itself: interfaces of neighbours then part (off: together)",
     offsetof(cli_extract_args, per_label)},
    {"table", 0, CLI_TEXT, "FILE",
     "Write a CSV of the labels: name, colour, volumes, area, components, neighbours",
     offsetof(cli_extract_args, table), CLI_VALUES_CSV},
    CLI_HEADED("Isovalue and surface"),
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "Which values are inside the solid (auto: above; in level sets below)",
     offsetof(cli_extract_args, inside)},
    {"open", 0, CLI_FLAG, NULL,
     "Leave the surface open at the border of the volume (off: capped)",
     offsetof(cli_extract_args, open)},
    {"topology", 0, CLI_CHOICE, "field/simple",
     "Ambiguous cells: as the trilinear field connects them, or by one table (field)",
     offsetof(cli_extract_args, topology)},
    {"placement", 0, CLI_CHOICE, "linear/cubic",
     "Interpolation along an edge: linear, or cubic through the samples (linear)",
     offsetof(cli_extract_args, placement)},
    {"snap", 0, CLI_NUMBER, "T",
     "Merge vertices closer to a sample than this fraction of an edge, up to 0.5; try 0.3 "
     "(off)",
     offsetof(cli_extract_args, snap)},
    {"min-volume", 0, CLI_VOLUME, "V",
     "Leave out components that enclose less, and all inside them: 500mm3, 0.5ml, 30vox "
     "(none)",
     offsetof(cli_extract_args, least)},
    {"largest", 0, CLI_COUNT, "N", "Keep the N components that enclose the most (all)",
     offsetof(cli_extract_args, largest)},
    {"fill-voids", 0, CLI_FLAG, NULL,
     "Leave out the cavities of solids, and all inside them (off)",
     offsetof(cli_extract_args, fill_voids)},
    {"close-handles", 0, CLI_LENGTH, "auto/L",
     "Close handles and tunnels by loops up to 4mm, 5vox, or auto: 3% of the surface's diagonal "
     "(none)",
     offsetof(cli_extract_args, handles)},
    {"smooth", 0, CLI_SMOOTHING, "METHOD",
     "Smooth the surface: taubin or hc, with their iterations (taubin:10), or fair, with the length "
     "of waves that keep half (fair:4vox) (off)",
     offsetof(cli_extract_args, smooth)},
    {"max-move", 0, CLI_LENGTH, "L", "How far --smooth may move a vertex (0.5vox)",
     offsetof(cli_extract_args, max_move)},
    {"cut-plane", 0, CLI_PLANE, "PLANE",
     "Cut by a plane, keep what is above, and close it flat: z=5mm, z=10% of the box, -z=5mm keeps "
     "what is below, or x,y,z:nx,ny,nz (off)",
     offsetof(cli_extract_args, cut)},
    {"engrave", 0, CLI_TEXT, "TEXT",
     "Engrave a text on the flattest place; may hold {stem} and {parent}; 'engrave' has more (none)",
     offsetof(cli_extract_args, engrave)},
    {"normals", 0, CLI_CHOICE, "field/none",
     "Vertex normals from the field's gradient, or none (field)",
     offsetof(cli_extract_args, normals)},
    {"crease-angle", 0, CLI_NUMBER, "off/DEG",
     "Let normals part at edges with a larger angle, in GLB and OBJ; a simplified surface parts them at "
     "caps (off)",
     offsetof(cli_extract_args, crease)},
    {"preview", 0, CLI_FLAG, NULL,
     "Give a quick look from every 4th voxel along each axis (off)",
     CLI_INPUT_ROW(cli_extract_args, preview)},
    {"coarsen", 0, CLI_COUNT, "N",
     "Use every N-th voxel along each axis, as a preview (4 with --preview, else 1)",
     CLI_INPUT_ROW(cli_extract_args, coarsen)},
    {"accel", 0, CLI_CHOICE, "octree/none",
     "Octree that several isovalues share; the result is the same (octree)",
     offsetof(cli_extract_args, accel)},
    {"profile", 'p', CLI_CHOICE, "none/print/" CLI_ASSET_CHOICES,
     "Make what a print needs, and check it as 'check' does; or what is drawn: levels of detail with "
     "texture coordinates and a normal map, within the budget (none)",
     offsetof(cli_extract_args, profile)},
    CLI_PRINTER_OPTIONS(cli_extract_args),
    CLI_ORIENT_PRINT_OPTION(offsetof(cli_extract_args, orient_print)),
    CLI_COLOR_OPTIONS(cli_extract_args),
    CLI_HEADED("Simplify while extracting"),
    {"simplify", 0, CLI_REDUCTION, "L|N",
     "Error limit (0.1mm, 0.5vox) or triangle count (50k) to simplify to (off)",
     offsetof(cli_extract_args, simplify)},
    {"max-error", 0, CLI_LENGTH, "L",
     "Error limit as with --simplify, and measured both ways; with --camera out of sight "
     "(off)",
     offsetof(cli_extract_args, pixel.most)},
    {"lod", 0, CLI_COUNTS, "N[,N...]",
     "Triangle counts of levels of detail, such as 50k,12k,3k, of labels in all: a file each, "
     "and a glTF with all (none)",
     offsetof(cli_extract_args, lod)},
    {"measure", 0, CLI_FLAG, NULL,
     "Measure the error of --simplify, --lod and --smooth, which takes a while (on; --no-measure)",
     offsetof(cli_extract_args, measure)},
    CLI_FORCE_OPTION(cli_extract_args, common),
    CLI_HEADED("Texture"),
    {"uv", 0, CLI_FLAG, NULL, "Lay the surface flat in a square: texture coordinates (off)",
     offsetof(cli_extract_args, texture) + offsetof(cli_texture_args, uv)},
    CLI_ATLAS_OPTIONS(offsetof(cli_extract_args, texture)),
    {"maps", 0, CLI_TEXT, "NAME[,NAME...]",
     "Maps to bake of the surface before --simplify or --lod: normals, occlusion, curvature, "
     "thickness, colors of --color-by (none)",
     offsetof(cli_extract_args, texture) + offsetof(cli_texture_args, maps)},
    {"pivot", 0, CLI_CHOICE, "file/base/centre",
     "Move to 0,0,0 the middle of the box, or that of its lower side (the volume's zero stays)",
     offsetof(cli_extract_args, pivot)},
    CLI_HEADED("Only what cameras see"),
    {"camera", 0, CLI_TEXT, "FILE[,FILE...]",
     "Keep only the detail that these cameras need: .json files of 'render', or the text of "
     "one; with --pixel-error",
     offsetof(cli_extract_args, pixel.camera), CLI_VALUES_JSON_INPUT},
    {"pixel-error", 0, CLI_NUMBER, "N",
     "Largest movement of the visible surface, in pixels of --camera",
     offsetof(cli_extract_args, pixel.pixels)},
    {"cull", 0, CLI_FLAG, NULL,
     "Leave out what no camera sees, outside its picture or behind the surface (off)",
     offsetof(cli_extract_args, pixel.cull)},
    {"size", 0, CLI_SIZES, "WxH", "Size of the cameras' pictures in pixels (1280x720)",
     offsetof(cli_extract_args, pixel.size)},
    {"shading", 0, CLI_NUMBER, "DEG",
     "Simplify the visible surface only where normals agree within this angle; 180 is "
     "anywhere (1.5)",
     offsetof(cli_extract_args, pixel.shading)},
    CLI_HEADED("Time series"),
    {"steps", 0, CLI_STEPS, "A:B:S/N,.../all",
     "Time steps to extract, counted from 0, a mesh each (of one file: --step; of files: "
     "all)",
     offsetof(cli_extract_args, steps)},
    {"animate", 0, CLI_FLAG, NULL,
     "Write one glTF file that shows the steps one after another (off)",
     offsetof(cli_extract_args, animate)},
    {"fps", 0, CLI_NUMBER, "N", "Steps a second of --animate (as the file times them, else 10)",
     offsetof(cli_extract_args, fps)},
    {"pvd", 0, CLI_TEXT, "FILE",
     "List to write for ParaView: the .vtp files of the steps, with their times",
     offsetof(cli_extract_args, pvd), CLI_VALUES_PVD},
    CLI_HEADED("Parts, for many processes or machines"),
    {"part", 0, CLI_TEXT, "K/N",
     "Extract only part K of N into --manifest; 'join' makes one file of all parts (the whole)",
     offsetof(cli_extract_args, part)},
    {"manifest", 0, CLI_TEXT, "DIR",
     "Folder of the parts of --part, or of mpirun, and of the record of their job; made if need be",
     offsetof(cli_extract_args, manifest), CLI_VALUES_FOLDER},
    {"parts", 0, CLI_COUNT, "N",
     "Number of parts of mpirun with --manifest (one for 64 slices)",
     offsetof(cli_extract_args, parts)},
    CLI_HEADED("Output file"),
    {"format", 0, CLI_TEXT, "NAME", "Format to write; names as in 'formats' (by extension)",
     offsetof(cli_extract_args, format), CLI_VALUES_MESH_WRITER},
    {"name", 0, CLI_TEXT, "TEXT", "Name of the object inside the file (the file's)",
     offsetof(cli_extract_args, name)},
    {"local", 0, CLI_FLAG, NULL,
     "Write coordinates relative to the mesh's origin, which is printed (off: world)",
     offsetof(cli_extract_args, local)},
    {"no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",
     offsetof(cli_extract_args, no_clobber)},
    CLI_JSON_OPTION(cli_extract_args),
    {"check", 0, CLI_FLAG, NULL, "Measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(cli_extract_args, check)},
    {"prove-crop", 0, CLI_FLAG, NULL,
     "Extract the whole volume as well, to prove that --crop changes nothing inside (off)",
     offsetof(cli_extract_args, prove_crop)},
    CLI_BATCH_OPTIONS(cli_extract_args),
    CLI_COMPRESS_OPTIONS(cli_extract_args, CLI_LENGTH),
    CLI_PREPARING_OPTIONS(cli_extract_args),
    CLI_INSIDE_OPTIONS(cli_extract_args),
    CLI_READING_OPTIONS(cli_extract_args),
    {"stream", 0, CLI_CHOICE, "auto/always/never",
     "Read and extract slice by slice: if the volume exceeds --memory, always, or never (auto)",
     offsetof(cli_extract_args, stream)},
    {"slab", 0, CLI_COUNT, "N",
     "Layers that --stream extracts together; the result is the same (as memory allows)",
     offsetof(cli_extract_args, slab)},
    {"max-triangles", 0, CLI_COUNT, "N",
     "Stop before making more triangles than this, such as 100M (no limit)",
     offsetof(cli_extract_args, max_triangles)},
    CLI_PROGRESS_OPTION(cli_extract_args),
};

/* Rules between stages of the surface are not here: extract_stages.c asks cw_pipeline_check(). */
static const cli_rule rules[] = {
    CLI_COMPRESS_RULES,
    CLI_PRINTER_RULES,
    {"range colormap", CLI_NEEDS, "color-by"},
    {"names smooth-labels table shared-faces per-label require-labels round probabilities",
     CLI_NEEDS, "labels"},
    {"labels", CLI_EXCLUDES,
     "iso inside topology placement snap profile=print max-error pixel-error shading size no-measure fps "
     "steps animate pvd prove-crop pivot component=mag denoise remove-table mask mask-open mask-close"},
    {"probabilities", CLI_EXCLUDES,
     "round min-volume largest fill-voids resample component step stream=always"},
    {"per-label", CLI_NEEDS, "simplify"},
    {"per-label", CLI_EXCLUDES, "shared-faces"},
    {"lod", CLI_EXCLUDES,
     "simplify max-error pixel-error shading size snap steps animate pvd prove-crop shared-faces"},
    {"simplify", CLI_EXCLUDES, "camera max-error"},
    {"pixel-error cull shading size", CLI_NEEDS, "camera"},
    {"camera", CLI_NEEDS, "pixel-error cull"},
    {"shading", CLI_NEEDS, "pixel-error"},
    {"snap", CLI_EXCLUDES, "simplify max-error pixel-error cull"},
    {"max-move", CLI_NEEDS, "smooth"},
    {"no-measure", CLI_NEEDS, "simplify lod smooth profile=game profile=web profile=mobile"},
    {"profile=print", CLI_EXCLUDES, "open cull lod animate no-check"},
    {"fps", CLI_NEEDS, "animate"},
    {"pvd", CLI_EXCLUDES, "animate"},
    {"maps atlas margin map-bits texel-density", CLI_NEEDS,
     "uv profile=game profile=web profile=mobile"},
    {"maps", CLI_NEEDS,
     "simplify lod max-error pixel-error profile=game profile=web profile=mobile"},
    {"profile=game profile=web profile=mobile", CLI_EXCLUDES,
     "labels open cull animate steps pvd snap part parts manifest"},
    {"uv", CLI_EXCLUDES, "animate"},
    {"engrave", CLI_EXCLUDES, "labels open cull"},
    {"crease-angle", CLI_EXCLUDES, "normals=none"},
    {"orient-print", CLI_EXCLUDES,
     "labels lod animate part parts manifest profile=game profile=web profile=mobile"},
    {"prove-crop", CLI_NEEDS, "crop"},
    {"prove-crop", CLI_EXCLUDES,
     "preview coarsen snap resample denoise remove-table mask mask-open mask-close"},
};

/* The next surface of the report; frames have no file of their own. */
static cli_made *begin_surface(cli_extract_run *s, const cli_moment *moment, size_t level)
{
    const size_t n = s->output.report.made_count;
    const char *path = s->args->animate ? NULL : s->output.files.path[n];
    cli_made *made = cli_report_next(&s->output.report, path, s->args->iso.value[level]);
    made->moment = s->input.series.given ? moment : NULL;
    made->timed = s->input.series.timed;
    return made;
}

/* An error of one step among several says of which. */
static void name_step(const cli_extract_run *s, const cli_moment *moment, cw_error *err)
{
    const cw_error why = *err;
    if (s->input.series.given)
        cwi_fail(err, why.status, "step %zu: %s", moment->number, why.message);
}

/* Into its file, with the record of how it was made. */
static cw_status deliver_level(cli_extract_run *s, size_t level, const cw_part *parts,
                               size_t count, size_t border_loops, cw_error *err)
{
    cli_making making;
    cw_provenance provenance[CLI_EXTRACT_PROVENANCE];
    cli_delivery how = cli_extract_describe_delivery(s);
    how.write.provenance = provenance;
    how.write.provenance_count = cli_extract_provenance(s, level, &making, provenance);
    /* each step was measured by itself; a surface in a spool was on its way */
    how.unchecked = how.unchecked || how.write.animated || parts->spool;
    how.parts = how.write.animated ? "steps" : NULL;
    return cli_deliver(&s->output.report, &how, parts, count, border_loops, s->output.start,
                       err);
}

/* Makes a surface slice by slice. A simplified one is in memory then. */
static cw_status stream_surface(cli_extract_run *s, const cli_moment *moment, size_t level,
                                cli_made *made, cw_error *err)
{
    cli_streamed out;
    cw_status st = cli_extract_streamed(s, moment, made, &out, err);
    const cw_part part = {.mesh = out.spool ? cw_mesh_spool_frame(out.spool) : &out.mesh,
                          .spool = out.spool};
    if (st == CW_OK)
        st = deliver_level(s, level, &part, 1, made->facts.extracted.border_loops, err);
    cli_free_streamed(&out);
    return st;
}

/* Ends a surface: keeps its error in the report. */
static cw_status finish_surface(cli_extract_run *s, const cli_moment *moment, cli_made *made,
                                cw_status st, cw_error *err)
{
    s->output.start = cli_seconds();
    if (st == CW_OK)
        return CW_OK;
    name_step(s, moment, err);
    made->error = *err;
    return st;
}

static cw_status make_surface(cli_extract_run *s, const cli_moment *moment, size_t n,
                              cw_error *err)
{
    cli_made *made = begin_surface(s, moment, n);
    if (s->input.volume.streams)
        return finish_surface(s, moment, made, stream_surface(s, moment, n, made, err), err);
    const cli_delivery how = cli_extract_describe_delivery(s);
    cw_mesh mesh = {0};
    const cw_extract_counts *counts = &made->facts.extracted;
    cw_status st = cli_extract_make(s, moment, made, &mesh, err);
    if (st != CW_OK && cli_turn_to_slices(s, st))
        return finish_surface(s, moment, made, stream_surface(s, moment, n, made, err), err);
    made->snapped = st == CW_OK && s->args->snap.value > 0;
    made->snap = made->snapped ? counts->snap : (cw_snap_counts){0};
    if (st == CW_OK && (cli_extract_is_simplified(s->args) || s->args->smooth.given))
        st = cli_extract_judge(s, made, &mesh, err);
    if (st == CW_OK)
        st = cli_extract_prove(s, made, &mesh, err);
    if (st == CW_OK)
        st = cli_extract_prove_crop(s, moment, made, err);
    if (st == CW_OK)
        st = cli_extract_place(s, made, &mesh, err);
    const cw_part part = {.mesh = &mesh, .textures = cli_find_textures(&s->output.maps)};
    if (st == CW_OK)
        st = s->args->animate ? cli_deliver_step(&s->output.report, &how, &mesh,
                                                 counts->border_loops, s->output.start, err)
                              : deliver_level(s, n, &part, 1, counts->border_loops, err);
    if (st == CW_OK && made->path)
        st = cli_write_maps(&s->output.maps, made->path, s->args->no_clobber, err);
    if (st == CW_OK)
        st = cli_extract_judge_print(s, made, &mesh, err);
    if (s->args->animate && (st == CW_OK || st == CW_ERR_EMPTY))
        cli_frames_add(&s->output.frames, &mesh, moment, s->plan.fps);
    if (s->input.extractor)
        cw_extractor_recycle(s->input.extractor, &mesh);
    cw_mesh_free(&mesh);
    cli_free_maps(&s->output.maps);
    return finish_surface(s, moment, made, st, err);
}

/* Makes the surfaces of all levels of a step. An empty surface among several is reported and
 * counted; any other failure ends the run. */
static cw_status make_surfaces(cli_extract_run *s, const cli_moment *moment, size_t *empty,
                               cw_error *err)
{
    const size_t levels = s->args->iso.count;
    if (s->args->lod.count)
        return cli_extract_make_lod(s, err);
    for (size_t n = 0; n < levels; n++) {
        cw_status st = make_surface(s, moment, n, err);
        if (st != CW_OK && (st != CW_ERR_EMPTY || levels * s->input.series.count == 1))
            return st;
        if (st == CW_ERR_EMPTY && s->args->animate)
            cli_report_warn(&s->output.report, "%s; nothing is shown in its time",
                            err->message);
        else if (st == CW_ERR_EMPTY)
            cli_say_error(err->message);
        *empty += st == CW_ERR_EMPTY;
    }
    return CW_OK;
}

/* Returns the memory of a step to the system. By itself glibc keeps blocks of this size, and
 * the blocks of the next step do not quite fit into the gaps. */
static void free_step(cli_extract_run *s)
{
    cli_free_volume(&s->input.volume);
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

static cw_status prepare_inside(cli_extract_run *s, cw_error *err)
{
    return cli_prepare_inside(&s->args->input, &s->input.volume, s->iso->value, s->iso->count,
                              cli_extract_is_low(s), err);
}

static cw_status read_volume(cli_extract_run *s, const cli_moment *moment, cw_error *err)
{
    cli_input input = s->args->input;
    input.makes_surface = true;
    input.step = moment->step;
    input.step_chosen = s->input.series.given;
    input.stream = s->args->stream;
    input.may_stream = !cli_find_unstreamed(s->args, CW_SOURCE_SLICES);
    free_step(s);
    s->input.turned = false;
    cli_report_begin(&s->output.report);
    cw_status st = cli_read_volume(moment->path, &input, false, &s->input.volume, err);
    if (st == CW_ERR_LIMIT && !input.may_stream)
        return cli_fail_whole(st, cli_find_unstreamed(s->args, CW_SOURCE_SLICES), err);
    if (st != CW_OK)
        return st;
    const cw_volume *v = &s->input.volume.view;
    st = cli_extract_check_error(s->args, &s->input.volume, err);
    if (st == CW_OK)
        st = cli_choose_levels(&s->input.volume, &input, s->iso, err);
    if (st == CW_OK)
        st = prepare_inside(s, err);
    if (st == CW_OK && !s->output.report.input)
        st = cli_tell_labels(&s->input.volume, s->args->iso.value, s->args->iso.count,
                             cli_extract_is_low(s), err);
    if (st != CW_OK)
        return st;
    if (!s->output.report.input)
        s->input.first = s->input.volume; /* without its label table, which has one owner */
    s->input.first.labels = (cw_label_table){0};
    s->output.report.input = &s->input.first;
    cli_report_read(&s->output.report, &s->input.volume);
    for (int r = 0; r < 3; r++)
        cli_say_vv("affine   %12.6g %12.6g %12.6g %12.6g", v->affine[r][0], v->affine[r][1],
                   v->affine[r][2], v->affine[r][3]);
    return CW_OK;
}

/* The voxels of a step: those of one file are all in memory. */
static cw_status open_step(cli_extract_run *s, const cli_moment *moment, cw_error *err)
{
    const bool held = s->input.volume.voxels.data && s->input.volume.path == moment->path;

    cw_status st = held ? cli_choose_step(&s->args->input, moment->step, &s->input.volume, err)
                        : read_volume(s, moment, err);
    if (held && st == CW_OK)
        st = prepare_inside(s, err);
    s->input.memory = held ? s->input.memory : s->input.volume.memory_left;
    s->input.volume.memory_left =
        s->input.memory > s->output.frames.bytes ? s->input.memory - s->output.frames.bytes : 1;
    cw_extractor_free(s->input.extractor);
    s->input.extractor = NULL;
    if (st != CW_OK || s->args->iso.count == 1 || s->args->accel || s->input.volume.streams ||
        cli_extract_is_simplified(s->args))
        return st;
    st = cw_extractor_new(&s->input.volume.view, &s->input.extractor, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, s->input.volume.path);
}

static cw_status fail_empty(const cli_extract_run *s, size_t empty, size_t count, cw_error *err)
{
    const char *what = s->input.series.count == 1 ? "isovalues"
                       : s->args->iso.count == 1  ? "steps"
                                                  : "surfaces";
    return cwi_fail(err, CW_ERR_EMPTY, "%s: %zu of %zu %s are empty", s->args->common.inputs[0],
                    empty, count, what);
}

static cw_status make_steps(cli_extract_run *s, size_t *empty, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->input.series.count && st == CW_OK; n++) {
        st = open_step(s, &s->input.series.moments[n], err);
        if (st == CW_OK)
            st = make_surfaces(s, &s->input.series.moments[n], empty, err);
    }
    return st;
}

/* An animation has a place for steps that are empty: only nothing but such is no result. */
static cw_status animate_steps(cli_extract_run *s, cw_error *err)
{
    const cli_frames *f = &s->output.frames;
    if (f->empty == f->count)
        return fail_empty(s, f->empty, f->count, err);
    cli_made *made = cli_report_next(&s->output.report, s->output.files.path[0], 0);
    made->name = "all";
    cw_status st = deliver_level(s, 0, f->parts, f->count, 0, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status write_pvd(cli_extract_run *s, cw_error *err)
{
    const cw_write_desc desc = cli_extract_write_desc(s->args);
    return cli_write_pvd(&s->output.report, s->args->pvd, &desc, err);
}

/* A file that times its steps is believed unless --fps says otherwise. */
static cw_status plan_frames(cli_extract_run *s, cw_error *err)
{
    const cli_extract_args *args = s->args;
    if (!args->animate)
        return CW_OK;
    if (s->input.series.count < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: --animate needs several time steps; there is 1",
                        args->common.inputs[0]);
    s->plan.fps = args->fps.given ? args->fps.value : s->input.series.timed ? 0 : DEFAULT_FPS;
    if (!args->fps.given && !s->input.series.timed)
        cli_say("%s: the steps have no times; the animation shows %d a second (--fps)",
                args->common.inputs[0], DEFAULT_FPS);
    return cli_frames_reserve(&s->output.frames, s->input.series.count, err);
}

/* Returns the name of the report's list of meshes; NULL: there is one mesh, and no list. */
static const char *name_results(const cli_extract_args *args, bool is_list)
{
    return args->lod.count ? "levels" : is_list ? "surfaces" : NULL;
}

static cw_status plan_steps(cli_extract_run *s, cw_error *err)
{
    const cli_extract_args *args = s->args;
    cli_steps steps = args->steps;
    steps.all = steps.all || (args->animate && !steps.given);
    steps.given = steps.given || args->animate;
    cw_status st = cli_find_series(&s->input.series, &args->common, &args->input, &steps, err);
    if (st == CW_OK)
        st = cli_extract_check_lod_steps(s, err);
    if (st == CW_OK)
        st = cli_extract_check_outputs(s, err);
    const size_t surfaces =
        args->lod.count ? args->lod.count : s->input.series.count * args->iso.count;
    s->output.report.several = name_results(args, surfaces > 1 || s->input.series.given);
    if (st == CW_OK)
        st = cli_report_reserve(&s->output.report, surfaces + 1, err);
    return st == CW_OK ? plan_frames(s, err) : st;
}

static cw_status extract_surfaces(void *state, cw_error *err)
{
    cli_extract_run *s = state;
    size_t empty = 0;
    cw_status st = cli_extract_check_args(s, err);
    if (st == CW_OK)
        st = plan_steps(s, err);
    if (st == CW_OK)
        st = make_steps(s, &empty, err);
    if (st == CW_OK && s->args->animate)
        return animate_steps(s, err);
    if (st == CW_OK && s->args->pvd)
        st = write_pvd(s, err);
    return st == CW_OK && empty
               ? fail_empty(s, empty, s->input.series.count * s->args->iso.count, err)
               : st;
}

static cw_status run_extract(void *p, cw_error *err)
{
    cli_extract_args *args = p;
    cli_extract_run s = {.args = args,
                         .iso = &args->iso,
                         .coloring.args = &args->color,
                         .output.start = cli_seconds()};
    cli_extract_fill_profile(args);
    if (cw_team_is_started() && !args->part) /* else each rank is a worker */
        return cli_extract_ranks(args, err);
    if (args->part || args->manifest || args->parts)
        return cli_extract_part(args, err);
    if (args->labels)
        return cli_extract_labels(args, err);
    if (!args->iso.count && args->output &&
        cli_is_level_set(args->common.inputs[0], &args->input))
        args->iso.count = 1; /* 0 */
    s.output.report.command = "extract";
    s.output.report.several = name_results(args, args->iso.count > 1);
    s.output.report.params = cli_extract_put_params;
    s.output.report.facts = cli_extract_put_series;
    s.output.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = extract_surfaces,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.output.report, err);
    for (size_t n = 0; n < s.plan.view_count; n++)
        cw_simplify_view_free(s.plan.views + n);
    cw_extractor_free(s.input.extractor);
    cli_frames_free(&s.output.frames);
    cli_free_coloring(&s.coloring);
    cli_free_maps(&s.output.maps);
    cli_free_volume(&s.input.volume);
    cli_free_outputs(&s.output.files);
    cli_free_series(&s.input.series);
    return st;
}

const cli_command cli_extract = {
    .name = "extract",
    .usage = "VOLUME... --iso V|--labels LIST -o MESH [options]",
    .about = "Extract the surface at an isovalue from a volume, as a mesh",
    .page = cli_page_extract,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_VOLUME,
    .size = sizeof(cli_extract_args),
    .defaults = &defaults,
    .run = run_extract,
};
