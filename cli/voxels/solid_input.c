/* Reads solids for commands that fill them with voxels, and tells what became of them. */
#include "cli/voxels/solid_input.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

static cw_status read_files(const char *const *paths, size_t count, const char *reader,
                            const cli_input *input, cli_solids *s, cw_error *err)
{
    s->files = calloc(count, sizeof *s->files);
    if (!s->files)
        return cwi_fail_memory(err);
    for (; s->file_count < count; s->file_count++) {
        cli_mesh *m = &s->files[s->file_count];
        cw_status st = cli_read_parts(paths[s->file_count], reader, input, m, err);
        if (st != CW_OK)
            return st;
        size_t triangles = 0;
        for (size_t p = 0; p < m->part_count; p++) {
            triangles += m->parts[p].mesh->triangle_count;
            s->count += m->parts[p].mesh->triangle_count > 0;
        }
        if (!triangles)
            return cwi_fail(err, CW_ERR_EMPTY, "%s: there are no triangles", m->path);
    }
    return CW_OK;
}

/* Names a part: by its name, else by the file, with a number where that has several. */
static char *name_part(const cli_mesh *m, size_t p)
{
    if (m->parts[p].name && *m->parts[p].name)
        return cwi_strdup(m->parts[p].name);
    char *stem = cli_stem(m->path);
    const size_t size = stem ? strlen(stem) + 24 : 0;
    char *name = stem ? cwi_alloc_array(size, 1) : NULL;
    if (name && m->part_count > 1)
        snprintf(name, size, "%s %zu", stem, p + 1);
    else if (name)
        snprintf(name, size, "%s", stem);
    free(stem);
    return name;
}

static int compare_values(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Chooses the values of labels: those of the files, if all are there and differ. */
static void choose_values(cli_solids *s)
{
    bool differ = true;
    for (size_t n = 0; n < s->count; n++)
        s->labels[n] = s->solid[n].label.value;
    qsort(s->labels, s->count, sizeof *s->labels, compare_values);
    for (size_t n = 0; n < s->count; n++)
        differ = differ && s->labels[n] && (n == 0 || s->labels[n] != s->labels[n - 1]);
    for (size_t n = 0; n < s->count; n++) {
        if (!differ)
            s->solid[n].label.value = (uint32_t)(n + 1);
        s->labels[n] = s->solid[n].label.value;
    }
}

static cw_status list_solids(cli_solids *s, cw_error *err)
{
    s->solid = calloc(s->count, sizeof *s->solid);
    s->meshes = calloc(s->count, sizeof *s->meshes);
    s->parts = calloc(s->count, sizeof *s->parts);
    s->labels = calloc(s->count, sizeof *s->labels);
    if (!s->solid || !s->meshes || !s->parts || !s->labels)
        return cwi_fail_memory(err);
    size_t n = 0;
    for (size_t f = 0; f < s->file_count; f++)
        for (size_t p = 0; p < s->files[f].part_count; p++) {
            const cw_part *part = &s->files[f].parts[p];
            cw_mesh *mesh = (cw_mesh *)part->mesh; /* of this reading */
            if (!mesh->triangle_count)
                continue;
            cw_status st = cw_mesh_weld(mesh, NULL, err);
            if (st != CW_OK)
                return cwi_fail_in(err, st, s->files[f].path);
            cli_solid *solid = &s->solid[n];
            *solid = (cli_solid){
                .path = s->files[f].path, .mesh = mesh, .name = name_part(&s->files[f], p)};
            if (!solid->name)
                return cwi_fail_memory(err);
            if (part->label)
                solid->label = *part->label;
            solid->label.name = solid->name;
            solid->label.layer = 0;
            s->triangles += mesh->triangle_count;
            s->meshes[n++] = mesh;
        }
    choose_values(s);
    return CW_OK;
}

cw_status cli_read_solids(const char *const *paths, size_t count, const char *reader,
                          const cli_input *input, cli_solids *solids, cw_error *err)
{
    *solids = (cli_solids){0};
    cw_status st = read_files(paths, count, reader, input, solids, err);
    return st == CW_OK ? list_solids(solids, err) : st;
}

void cli_free_solids(cli_solids *s)
{
    for (size_t n = 0; n < s->count && s->solid; n++)
        cwi_free(s->solid[n].name);
    for (size_t n = 0; n < s->file_count; n++)
        cli_free_mesh(&s->files[n]);
    free(s->files);
    free(s->solid);
    free(s->meshes);
    free(s->parts);
    free(s->labels);
    *s = (cli_solids){0};
}

/* --- messages ------------------------------------------------------------------------------ */

/* Prints the file of a solid, and its name where several are read. */
static const char *describe_solid(const cli_solids *s, size_t n, char text[512])
{
    if (s->count > 1)
        snprintf(text, 512, "%s: '%s'", s->solid[n].path, s->solid[n].name);
    else
        snprintf(text, 512, "%s", s->solid[n].path);
    return text;
}

cw_status cli_fail_solids(const cli_solids *s, cw_status status, cw_error *err)
{
    char text[512];
    for (size_t n = 0; n < s->count; n++)
        if (s->parts[n].open)
            return cwi_fail_in(err, status, describe_solid(s, n, text));
    return cwi_fail_in(err, status, describe_solid(s, 0, text));
}

static void tell_form(const char *which, const cw_voxelize_part *p)
{
    if (p->turned)
        cli_say("%s: inside out, and turned", which);
    if (p->repeated)
        cli_say("%s: it overlaps itself around %s voxels, which count once", which,
                cli_count(p->repeated));
    if (p->negative)
        cli_say(
            "%s: shells are inside out around %s voxels, which count as outside; 'convert --orient' turns "
            "them",
            which, cli_count(p->negative));
    if (p->outside_mm2 > 0)
        cli_say("%s: %.3g %% of its surface is outside of the grid, and cut off", which,
                100 * p->outside_mm2 / p->area_mm2);
    if (p->overlapped)
        cli_say("%s: takes %s voxels from parts before it, which overlap it", which,
                cli_count(p->overlapped));
}

void cli_tell_solids(const cli_solids *s, bool partial)
{
    char which[512];
    for (size_t n = 0; n < s->count; n++) {
        const cw_voxelize_part *p = &s->parts[n];
        tell_form(describe_solid(s, n, which), p);
        if (p->lost)
            cli_say("%s: %s of %s solids %s thinner than a voxel, and %s", which,
                    cli_count(p->lost), cli_count(p->solids), p->lost == 1 ? "is" : "are",
                    partial ? "no voxel of them is half covered" : "lost");
        else if (p->thin_places)
            cli_say("%s: %s place%s with %.3g %% of its surface %s too thin for the voxels",
                    which, cli_count(p->thin_places), p->thin_places == 1 ? "" : "s",
                    100 * p->thin_mm2 / p->area_mm2, p->thin_places == 1 ? "is" : "are");
    }
}
