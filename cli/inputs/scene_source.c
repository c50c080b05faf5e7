/* Opens a mesh, a volume or a series of volumes for drawing, reads its steps, and finds its
 * box. */
#include "cli/inputs/scene_source.h"

#include "cli/framework/console.h"
#include "cli/inputs/mesh_input.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/volume/volume.h"

#include <math.h>
#include <sys/stat.h>

enum { DENSE_VOXELS = 512 * 512 * 512, MAX_STEPS = 16 };

bool cli_is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static cw_status look_at_file(cli_source *s, const char *path, const cli_input *input,
                              bool may_be_mesh, cw_error *err)
{
    cw_volume shape = {0};
    cw_error why = {0};
    cw_status st = cli_read_shape(path, input, &shape, &why);
    s->is_level_set = st == CW_OK && shape.known & CW_KNOWN_LEVEL_SET;
    s->is_label_map = st == CW_OK && shape.known & CW_KNOWN_LABELS;
    s->is_uneven = st == CW_OK && (shape.cells || cwi_is_rectilinear(&shape));
    cw_volume_free(&shape);
    s->is_mesh = st != CW_OK && may_be_mesh && !input->raw && s->series.count == 1 &&
                 !s->series.given && !cli_is_folder(path);
    if (!s->is_mesh)
        return CW_OK;
    cli_mesh file;
    st = cli_read_mesh(path, input->reader, input, &file, err);
    s->mesh = file.mesh;
    if (st == CW_ERR_FORMAT && !cw_mesh_format(path, NULL) && !input->reader)
        *err = why;
    return st;
}

cw_status cli_open_source(cli_source *source, const cli_common *common, const cli_input *input,
                          const cli_steps *steps, bool may_be_mesh, cw_error *err)
{
    cw_status st = cli_find_series(&source->series, common, input, steps, err);
    return st == CW_OK ? look_at_file(source, common->inputs[0], input, may_be_mesh, err) : st;
}

void cli_close_source(cli_source *source)
{
    cw_mesh_free(&source->mesh);
    cw_volume_free(&source->dense);
    cli_free_volume(&source->volume);
    cli_free_series(&source->series);
    *source = (cli_source){0};
}

cw_status cli_read_step(cli_source *source, const cli_input *input, size_t step, cw_error *err)
{
    const cli_moment *moment = &source->series.moments[step];
    cli_input at = *input;
    at.step = moment->step;
    at.step_chosen = source->series.given;
    at.array.component.given |= source->of_labels;
    at.of_labels |= source->of_labels;
    cw_volume_free(&source->dense);
    if (source->volume.voxels.data && source->volume.path == moment->path)
        return cli_choose_step(&at, moment->step, &source->volume, err);
    cli_free_volume(&source->volume);
    return cli_read_any_volume(moment->path, &at, &source->volume, err);
}

/* Reads a step to count its values alone. */
static cw_status count_step(cli_source *source, const cli_input *input, size_t step,
                            size_t bins, cw_statistics *out, cw_error *err)
{
    const cli_moment *moment = &source->series.moments[step];
    cli_input at = *input;
    cli_volume other = {0};
    if (source->volume.path == moment->path) {
        cw_status st = cli_read_step(source, input, step, err);
        return st == CW_OK ? cw_volume_statistics(&source->volume.view, bins,
                                                  (int)input->threads, out, err)
                           : st;
    }
    at.step = moment->step;
    at.sample = at.is_quiet = true;
    cw_status st = cli_read_volume(moment->path, &at, false, &other, err);
    if (st == CW_OK)
        st = cw_volume_statistics(&other.view, bins, (int)input->threads, out, err);
    cli_free_volume(&other);
    return st;
}

cw_status cli_find_statistics(cli_source *source, const cli_input *input, size_t step,
                              size_t bins, cw_statistics *out, cw_error *err)
{
    cw_statistics parts[MAX_STEPS] = {{0}};
    const size_t all = source->series.count, count = all < MAX_STEPS ? all : MAX_STEPS;
    cw_status st = CW_OK;
    if (count < 2)
        return cw_volume_statistics(&source->volume.view, bins, (int)input->threads, out, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = count_step(source, input, n * (all - 1) / (count - 1), bins, &parts[n], err);
    if (st == CW_OK)
        st = cli_read_step(source, input, step, err);
    if (st == CW_OK)
        st = cw_statistics_join(parts, count, bins, out, err);
    for (size_t n = 0; n < count; n++)
        cw_statistics_free(&parts[n]);
    return st;
}

cw_status cli_need_drawable(cli_source *source, const cli_input *input, cw_error *err)
{
    const cw_volume *v = &source->volume.view;
    cw_status st = CW_OK;
    if (v->sparse && !source->dense.data) {
        st = cw_volume_densify(v, input->max_voxels ? input->max_voxels : DENSE_VOXELS,
                               &source->dense, err);
        if (st == CW_OK)
            cli_say("%s: a sparse grid, drawn as a dense one of %zu x %zu x %zu voxels",
                    source->volume.path, v->dim[0], v->dim[1], v->dim[2]);
    }
    return st;
}

cw_mode cli_default_mode(const cli_source *source)
{
    return source->is_uneven ? CW_MODE_VBUFFER : CW_MODE_COMPOSITE;
}

const cw_volume *cli_drawn(const cli_source *source)
{
    return source->volume.view.sparse ? &source->dense : &source->volume.view;
}

bool cli_find_box(const cw_volume *volume, const cw_mesh *mesh, double box[2][3])
{
    double point[2][3];
    cwi_box_clear(box[0], box[1]);
    if (mesh && cw_mesh_bounds(mesh, point[0], point[1]))
        cwi_box_join(box[0], box[1], point[0], point[1]);
    double corners[8][3];
    if (volume && volume->cells)
        cw_volume_corners(volume, corners);
    for (int n = 0; n < 8 && volume && volume->cells; n++)
        cwi_box_add(box[0], box[1], corners[n]);
    for (int n = 0; n < 8 && volume && !volume->cells; n++) {
        double index[3];
        for (int a = 0; a < 3; a++)
            index[a] = volume->dim[a] == 1 ? (n >> a & 1) - 0.5
                       : n >> a & 1        ? (double)volume->dim[a] - 1
                                           : 0;
        cw_volume_to_world(volume, index, point[0]);
        cwi_box_add(box[0], box[1], point[0]);
    }
    return box[0][0] <= box[1][0];
}
