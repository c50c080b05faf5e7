/* Runs the modules dicom, tiff, picture, hdf5 and openvdb in sandboxed processes, and reads facts and planes
 * from them. */
#include "formats/volume/sandboxed_planes.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"

#include <stdatomic.h>
#include <string.h>

/* Modules that a child process has loaded successfully, in the order of the names. */
static const char *const names[] = {"dicom", "tiff", "picture", "hdf5", "openvdb"};
enum { MODULES = sizeof names / sizeof *names };
static atomic_bool survived[MODULES];

static atomic_bool *survived_of(const char *module)
{
    size_t n = 0;
    while (n + 1 < MODULES && strcmp(names[n], module) != 0)
        n++;
    return &survived[n];
}

static cw_status load_module(cwi_planes *planes, cw_error *err)
{
    const void *functions;
    cw_status st = cwi_module_load(planes->module, &functions, err);
    if (st != CW_OK)
        return st;
    planes->functions = functions;
    return planes->functions->prepare ? planes->functions->prepare(err) : CW_OK;
}

static cw_status prepare_module(void *state, cw_error *err)
{
    cwi_planes *planes = state;
    cw_status st = load_module(planes, err);
    if (st != CW_OK)
        return st;
    planes->state = planes->functions->state_new();
    return planes->state ? CW_OK : cwi_fail_memory(err);
}

static cw_status work_on_request(void *state, int fd, const void *request, void *shared,
                                 cw_error *err)
{
    const cwi_planes *planes = state;
    return planes->functions->work(planes->state, fd, request, shared, err);
}

cw_status cwi_planes_open(cwi_planes *planes, const char *module, const char *library,
                          const cw_read_desc *desc, cw_error *err)
{
    *planes = (cwi_planes){.module = module};
    const cwi_sandbox_desc box = {.library = library,
                                  .prepare = prepare_module,
                                  .work = work_on_request,
                                  .state = planes,
                                  .shared_bytes = CWI_PLANES_SHARED,
                                  .memory = desc->max_bytes,
                                  .timeout_s = desc->timeout_s,
                                  .inside = desc->no_sandbox};
    /* from the second file on, every child finds the library loaded, which saves a
     * tenth of a second */
    cw_status st = CW_OK;
    if (atomic_load(survived_of(module)) && !cwi_memory_is_limited())
        st = load_module(planes, err);
    if (st == CW_OK)
        st = cwi_sandbox_open(&planes->box, &box, err);
    planes->box.progress = &desc->progress;
    if (st == CW_OK)
        atomic_store(survived_of(module), true);
    return st;
}

cw_status cwi_planes_restart(cwi_planes *planes, cw_error *err)
{
    const cw_progress *progress = planes->box.progress;
    const cwi_sandbox_desc box = planes->box.desc;
    cwi_sandbox_close(&planes->box);
    cw_status st = cwi_sandbox_open(&planes->box, &box, err);
    planes->box.progress = progress;
    return st;
}

void cwi_planes_close(cwi_planes *planes)
{
    cwi_sandbox_close(&planes->box);
    if (planes->state)
        planes->functions->state_free(planes->state);
    *planes = (cwi_planes){0};
}

cw_status cwi_planes_facts(cwi_planes *planes, int fd, uint64_t file_bytes, const void **facts,
                           cw_error *err)
{
    const cwi_plane_request q = {
        .op = CWI_PLANE_FACTS, .image = planes->image, .file_bytes = file_bytes};
    *facts = planes->box.shared;
    return cwi_sandbox_run(&planes->box, fd, &q, sizeof q, err);
}

cw_status cwi_planes_read(cwi_planes *planes, uint32_t plane, size_t first_row,
                          size_t row_count, size_t row_bytes, void *to, cw_error *err)
{
    const size_t max = CWI_PLANES_SHARED / row_bytes;
    cw_status st = CW_OK;
    for (size_t row = 0, rows; st == CW_OK && row < row_count; row += rows) {
        rows = row_count - row < max ? row_count - row : max;
        const cwi_plane_request q = {.op = CWI_PLANE_PIXELS,
                                     .plane = plane,
                                     .first_row = (uint32_t)(first_row + row),
                                     .row_count = (uint32_t)rows};
        st = cwi_sandbox_run(&planes->box, -1, &q, sizeof q, err);
        if (st == CW_OK)
            memcpy((char *)to + row * row_bytes, planes->box.shared, rows * row_bytes);
    }
    return st;
}

cw_status cwi_planes_try(cwi_planes *planes, uint32_t count, size_t row_count, size_t row_bytes,
                         cw_error *err)
{
    void *pixels = cwi_alloc_array(row_count, row_bytes);
    cw_status st = pixels ? CW_OK : cwi_fail_memory(err);
    for (uint32_t n = 0; st == CW_OK && n < count; n++)
        st = cwi_planes_read(planes, n, 0, row_count, row_bytes, pixels, err);
    cwi_free(pixels);
    return st;
}
