/* Makes the surface of a volume that was read, within the memory that is left. */
#include "cli/inputs/extract_surface.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <string.h>

/* A closed surface has half as many vertices as triangles. It is written at the same time: what
 * the file loses takes LOSS_BYTES a vertex. */
size_t cli_check_bytes(void)
{
    enum { LOSS_BYTES = 28 };
    return cw_quality_bytes(500, 1000) / 1000 + 1 + LOSS_BYTES / 2;
}

size_t cli_slices_bytes(const cw_volume *shape, const cw_stream_desc *desc, size_t taken)
{
    return taken + CLI_BESIDE_SLICES + cw_extract_stream_bytes(shape, desc, true);
}

cw_status cli_limit_slices(const cli_slices *slices, const cw_volume *shape,
                           cw_stream_desc *desc, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], limit_text[CWI_MEMORY_TEXT];
    const size_t limit = slices->limit, unused = cwi_memory_left(),
                 taken = slices->turned && unused < limit ? limit - unused : cli_peak_bytes(),
                 beside = taken + CLI_BESIDE_SLICES,
                 needed = cli_slices_bytes(shape, desc, taken);
    if (needed <= limit) {
        desc->extract.max_bytes = limit - beside < unused ? limit - beside : unused;
        return CW_OK;
    }
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(limit, limit_text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "%s: slice by slice, the program needs %s; the limit is %s (--memory)",
                    slices->path, needed_text, limit_text);
}

/* Of the limit to voxels and surface, and of that to the whole process. */
static size_t memory_left(const cli_volume *volume)
{
    const size_t left = cwi_memory_left();
    return left < 1 ? 1 : left < volume->memory_left ? left : volume->memory_left;
}

cw_pipeline_desc cli_describe_full(const cli_surface_settings *set)
{
    cw_pipeline_desc desc = set->desc;
    desc.simplify = NULL;
    desc.view_count = desc.lod_count = 0;
    desc.cull = false;
    desc.atlas = NULL;
    desc.bake = NULL;
    desc.color = NULL;
    desc.watch = (cw_pipeline_watch){0};
    return desc;
}

cw_progress cli_stage_progress(void *user, cw_stage stage, size_t count, const char *unit)
{
    (void)user;
    (void)stage;
    const char *million = strcmp(unit, "voxel") == 0    ? "Mvoxel"
                          : strcmp(unit, "vertex") == 0 ? "Mvertex"
                                                        : "Mtriangle";
    return cli_progress((double)count / 1e6, million);
}

void cli_name_stage(cw_stage stage, char name[CLI_STAGE_BYTES])
{
    snprintf(name, CLI_STAGE_BYTES, "--%s", cw_stage_name(stage));
    for (char *c = name; *c; c++)
        *c = *c == '_' ? '-' : *c;
}

cw_status cli_explain_stages(const char *path, cw_status st, cw_error *err)
{
    char option[CLI_STAGE_BYTES];
    const cw_error why = *err;
    for (int s = 0; s < CW_STAGE_COUNT; s++) {
        const char *name = cw_stage_name((cw_stage)s);
        const size_t length = strlen(name);
        if (strncmp(why.message, name, length) != 0 || why.message[length] != ':')
            continue;
        cli_name_stage((cw_stage)s, option);
        cwi_fail(err, st, "%s%s", option, why.message + length);
    }
    /* Errors of temporary files name their folder; the input has no part in them. */
    return st == CW_OK || st == CW_ERR_OUTPUT ? st : cwi_fail_in(err, st, path);
}

static cw_status explain_error(const cli_volume *volume, cw_status st, cw_error *err)
{
    if (st == CW_ERR_EMPTY && cli_is_preview(volume))
        cwi_fail_in(err, st, "preview");
    return cli_explain_stages(volume->path, st, err);
}

cw_status cli_run_pipeline(const cli_volume *volume, cw_extractor *extractor,
                           const cw_pipeline_desc *desc, cw_pipeline_sink sink,
                           cw_pipeline_facts *facts, cw_error *err)
{
    cw_pipeline_desc d = *desc;
    d.extract.max_bytes = memory_left(volume);
    if (!d.watch.begin)
        d.watch.begin = cli_stage_progress;
    return explain_error(volume,
                         cw_pipeline_run(&volume->view, extractor, &d, sink, facts, err), err);
}

/* Moves the surface of the pipeline into a mesh. */
static cw_status take_mesh(void *user, cw_pipeline_surface *surface,
                           const cw_pipeline_facts *facts, cw_error *err)
{
    (void)facts;
    (void)err;
    *(cw_mesh *)user = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return CW_OK;
}

cw_pipeline_sink cli_mesh_sink(cw_mesh *mesh)
{
    *mesh = (cw_mesh){0};
    return (cw_pipeline_sink){take_mesh, mesh};
}

cw_status cli_make_surface(const cli_volume *volume, cw_extractor *extractor,
                           const cw_pipeline_desc *desc, cw_mesh *mesh,
                           cw_pipeline_facts *facts, cw_error *err)
{
    return cli_run_pipeline(volume, extractor, desc, cli_mesh_sink(mesh), facts, err);
}

cw_status cli_extract_surface(const cli_volume *volume, const cw_extract_desc *desc,
                              cw_mesh *mesh, cw_extract_counts *counts, cw_error *err)
{
    cw_pipeline_facts facts = {0};
    cw_status st = cli_make_surface(volume, NULL, &(cw_pipeline_desc){.extract = *desc}, mesh,
                                    &facts, err);
    if (counts)
        *counts = facts.extracted;
    return st;
}
