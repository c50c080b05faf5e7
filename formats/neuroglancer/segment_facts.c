/* Lists the segments of a mesh folder, measures them, and writes its JSON files. */
#include "formats/neuroglancer/segment_facts.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/volume/label_ids.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOLDER "segment_properties"
static const double NM_PER_MM = 1e6;

/* --- segments ---------------------------------------------------------------------------- */

void cwi_segments_free(cwi_segments *segments)
{
    cwi_free(segments->items);
    *segments = (cwi_segments){0};
}

static int compare_ids(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static cw_status check_ids(const cwi_segments *s, cw_error *err)
{
    cw_status st = CW_OK;
    uint64_t *ids = cwi_alloc_array(s->count, sizeof *ids);
    if (!ids)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < s->count; n++)
        ids[n] = s->items[n].id;
    qsort(ids, s->count, sizeof *ids, compare_ids);
    if (ids[0] == 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "label 0 cannot be a segment: neuroglancer keeps 0 for the background");
    for (size_t n = 1; n < s->count && st == CW_OK; n++)
        if (ids[n] == ids[n - 1])
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "label %" PRIu64
                          " is there twice, such as in two layers; a segment needs a "
                          "label of its own",
                          ids[n]);
    cwi_free(ids);
    return st;
}

cw_status cwi_segments_list(const cwi_parts *parts, cwi_segments *segments, cw_error *err)
{
    const cw_label *negative = NULL;
    size_t labels = 0;
    *segments = (cwi_segments){.items = cwi_alloc_zeroed(parts->count, sizeof(cwi_segment))};
    if (!segments->items)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < parts->count; p++) {
        const cwi_part *part = &parts->items[p];
        labels += part->label != NULL;
        if (part->level == 0) {
            cwi_segment *s = &segments->items[segments->count++];
            s->levels = part;
            s->id = part->label ? cwi_label_size(part->label) : segments->count;
            negative = part->label && part->label->is_negative ? part->label : negative;
        }
        cwi_segment *s = &segments->items[segments->count - 1];
        s->level_count = part->level + 1;
        if (s->level_count > segments->max_levels)
            segments->max_levels = s->level_count;
    }
    cw_status st =
        labels == 0 || labels == parts->count
            ? check_ids(segments, err)
            : cwi_fail(err, CW_ERR_ARGUMENT,
                       "%zu of %zu parts have a label; neuroglancer needs all or none", labels,
                       parts->count);
    if (st == CW_OK && negative)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "label %s is below 0: neuroglancer's segments are numbers from 1 on",
                      cw_label_number(negative, (char[CW_LABEL_NUMBER]){0}));
    if (st != CW_OK)
        cwi_segments_free(segments);
    return st;
}

/* --- measuring --------------------------------------------------------------------------- */

typedef struct facts {
    double volume_mm3, area_mm2;
    bool is_closed;
} facts;

static void find_corner(const cwi_part *part, size_t triangle, size_t corner, double at[3])
{
    const uint32_t v = part->mesh.triangles[3 * triangle + corner];
    for (int a = 0; a < 3; a++)
        at[a] = (double)part->mesh.positions[3 * (size_t)v + (size_t)a];
}

/* Hashes an edge with its direction [Steele2014]. */
static uint64_t hash_edge(uint32_t from, uint32_t to)
{
    uint64_t x = ((uint64_t)from << 32 | to) + 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

/* Measures a mesh. It is closed if each edge occurs as often in one direction as in the other:
 * then the sum of their hashes is zero. */
static facts measure_part(const cwi_part *part)
{
    facts f = {0};
    uint64_t sum = 0;
    for (size_t t = 0; t < part->mesh.triangle_count; t++) {
        const uint32_t *v = part->mesh.triangles + 3 * t;
        double p[3][3], normal[3];
        for (size_t k = 0; k < 3; k++) {
            find_corner(part, t, k, p[k]);
            sum += hash_edge(v[k], v[(k + 1) % 3]) - hash_edge(v[(k + 1) % 3], v[k]);
        }
        cwi_triangle_normal(p[0], p[1], p[2], normal);
        f.area_mm2 += cwi_length(normal) / 2;
        f.volume_mm3 += cwi_dot(p[0], normal) / 6;
    }
    f.is_closed = sum == 0;
    return f;
}

double cwi_mean_edge(const cwi_part *part)
{
    double sum = 0;
    for (size_t t = 0; t < part->mesh.triangle_count; t++)
        for (size_t k = 0; k < 3; k++) {
            double p[3], q[3];
            find_corner(part, t, k, p);
            find_corner(part, t, (k + 1) % 3, q);
            for (int a = 0; a < 3; a++)
                q[a] -= p[a];
            sum += cwi_length(q);
        }
    return sum / (3 * (double)part->mesh.triangle_count);
}

/* --- JSON -------------------------------------------------------------------------------- */

/* Saves a stream into memory as a file of the folder. */
static cw_status save_text(cwi_outfolder *folder, const char *name, FILE *out, char **text,
                           cw_error *err)
{
    if (!cwi_text_close(out, text))
        return cwi_fail_memory(err);
    cw_status st = cwi_outfolder_save(folder, name, *text, strlen(*text), err);
    free(*text);
    return st;
}

static void print_info(FILE *out, const cwi_lod_grid *grid, const cwi_segment_bits *bits)
{
    fprintf(out,
            "{\n  \"@type\": \"neuroglancer_multilod_draco\",\n"
            "  \"vertex_quantization_bits\": %d,\n  \"transform\": [",
            grid->bits);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            fprintf(out, "%s%.17g", r || c ? ", " : "",
                    c == 3   ? grid->origin[r] * NM_PER_MM
                    : c == r ? NM_PER_MM
                             : 0);
    fputs("],\n  \"lod_scale_multiplier\": 1,\n", out);
    if (bits->is_sharded)
        fprintf(out,
                "  \"sharding\": {\"@type\": \"neuroglancer_uint64_sharded_v1\", "
                "\"preshift_bits\": 0, \"hash\": \"murmurhash3_x86_128\",\n"
                "    \"minishard_bits\": %u, \"shard_bits\": %u, \"minishard_index_encoding\": "
                "\"raw\", \"data_encoding\": \"raw\"},\n",
                bits->minishard, bits->shard);
    fputs("  \"segment_properties\": \"" FOLDER "\"\n}\n", out);
}

cw_status cwi_mesh_info_write(cwi_outfolder *folder, const cwi_lod_grid *grid,
                              const cwi_segment_bits *bits, cw_error *err)
{
    char *text = NULL;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    void *before = cwi_locale_c();
    if (out)
        print_info(out, grid, bits);
    cwi_locale_restore(before);
    return save_text(folder, "info", out, &text, err);
}

/* Prints a name, which has no control characters or backslashes. */
static void print_name(FILE *out, const char *name)
{
    fputc('"', out);
    for (; *name; name++)
        fprintf(out, *name == '"' ? "\\%c" : "%c", *name);
    fputc('"', out);
}

typedef enum column { COLUMN_ID, COLUMN_NAME, COLUMN_VOLUME, COLUMN_AREA, COLUMN_COUNT } column;

static void print_column(FILE *out, const char *before, const cwi_segments *s,
                         const facts *measured, column which)
{
    fputs(before, out);
    for (size_t n = 0; n < s->count; n++) {
        const cwi_part *part = s->items[n].levels;
        fputs(n ? ", " : "", out);
        switch (which) {
        case COLUMN_ID:
            fprintf(out, "\"%" PRIu64 "\"", s->items[n].id);
            break;
        case COLUMN_NAME:
            print_name(out, part->name);
            break;
        case COLUMN_VOLUME:
            fprintf(out, "%.9g", measured[n].volume_mm3);
            break;
        case COLUMN_AREA:
            fprintf(out, "%.9g", measured[n].area_mm2);
            break;
        case COLUMN_COUNT:
            fprintf(out, "%zu", part->mesh.triangle_count);
            break;
        }
    }
    fputc(']', out);
}

static void print_properties(FILE *out, const cwi_segments *s, const facts *measured,
                             bool is_closed)
{
#define NUMBERS(id, type)                                                                      \
    "},\n      {\"id\": \"" id "\", \"type\": \"number\", \"data_type\": \"" type              \
    "\", \"values\": ["
    print_column(out,
                 "{\n  \"@type\": \"neuroglancer_segment_properties\",\n  \"inline\": {\n"
                 "    \"ids\": [",
                 s, measured, COLUMN_ID);
    print_column(out,
                 ",\n    \"properties\": [\n"
                 "      {\"id\": \"label\", \"type\": \"label\", \"values\": [",
                 s, measured, COLUMN_NAME);
    if (is_closed)
        print_column(out, NUMBERS("volume_mm3", "float32"), s, measured, COLUMN_VOLUME);
    print_column(out, NUMBERS("area_mm2", "float32"), s, measured, COLUMN_AREA);
    print_column(out, NUMBERS("triangles", "uint32"), s, measured, COLUMN_COUNT);
    fputs("}\n    ]\n  }\n}\n", out);
#undef NUMBERS
}

cw_status cwi_segment_properties_write(cwi_outfolder *folder, const cwi_segments *segments,
                                       cw_error *err)
{
    char *text = NULL;
    size_t size;
    bool is_closed = true;
    facts *measured = cwi_alloc_array(segments->count, sizeof *measured);
    if (!measured)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < segments->count; n++) {
        measured[n] = measure_part(segments->items[n].levels);
        is_closed = is_closed && measured[n].is_closed;
    }
    FILE *out = cwi_text_open(&text, &size);
    void *before = cwi_locale_c();
    if (out)
        print_properties(out, segments, measured, is_closed);
    cwi_locale_restore(before);
    cwi_free(measured);
    return save_text(folder, FOLDER "/info", out, &text, err);
}
