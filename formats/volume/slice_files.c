/* Finds slices in files of their own, checks that they belong together, and stacks them by their
 * numbers. */
#include "formats/volume/slice_files.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/volume/damaged_files.h"
#include "formats/volume/slice_spacing.h"

#include <string.h>
#include <unistd.h>

static bool is_of_kind(const cwi_slice_kind *kind, const cwi_input *in, const char *name)
{
    unsigned char head[CWI_SNIFF_BYTES];
    uint64_t size;
    size_t got = 0;
    int fd;
    if (cwi_has_extension(name, kind->extensions))
        return true;
    if (cwi_input_open_side(in, name, &fd, &size, NULL) != CW_OK)
        return false;
    const bool read = cwi_input_read_at(fd, 0, head, sizeof head, &got, NULL) == CW_OK;
    close(fd);
    return read && kind->sniff(head, got);
}

static size_t folder_length(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) : 0;
}

/* Checks that all files are in one folder; a pattern may match in several. */
static cw_status check_folder(const cwi_slice_kind *kind, const cwi_input *in,
                              const cwi_names *files, cw_error *err)
{
    const char *first = files->items[0];
    const size_t length = folder_length(first);
    if (cwi_files_is_pattern(in->path))
        return CW_OK;
    for (size_t i = 1; i < files->count; i++) {
        const char *name = files->items[i];
        if (folder_length(name) != length || memcmp(name, first, length) != 0)
            return cwi_fail(err, CW_ERR_UNSAFE,
                            "it has %s files in several folders, as are '%.80s' and '%.80s'; "
                            "name one of the folders, or a pattern",
                            kind->name, first, name);
    }
    return CW_OK;
}

cw_status cwi_slice_files_find(const cwi_slice_kind *kind, const cwi_input *in,
                               const cwi_names *names, const cw_read_desc *desc,
                               cwi_names *files, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < names->count; i++)
        if (is_of_kind(kind, in, names->items[i]))
            st = cwi_names_add(files, names->items[i], err);
    if (st == CW_OK && files->count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "it holds no %s file", kind->name);
    if (st == CW_OK && files->count < names->count)
        cwi_note(desc, "left out, because they are not %s: %zu of its files", kind->name,
                 names->count - files->count);
    return st == CW_OK ? check_folder(kind, in, files, err) : st;
}

static cw_status look_into(const cwi_slice_kind *kind, const cwi_input *in, const char *name,
                           bool is_first, cw_error *err)
{
    uint64_t size;
    int fd;
    cw_status st = cwi_input_open_side(in, name, &fd, &size, err);
    if (st != CW_OK)
        return st;
    st = kind->look(kind->user, fd, size, is_first, err);
    close(fd);
    return st;
}

/* Leaves a damaged file out if that was asked for. Reading it may have ended the library's
 * process. */
static cw_status leave_out(cwi_planes *planes, const cw_read_desc *desc, size_t files,
                           cwi_damaged *damaged, const char *name, const cw_error *reason,
                           cw_error *err)
{
    cw_status st = cwi_damaged_add(damaged, name, "", reason, err);
    if (st == CW_OK && !desc->skip_damaged && files > 1)
        return cwi_damaged_fail(&damaged->items[0], err);
    return st == CW_OK && !planes->box.open ? cwi_planes_restart(planes, err) : st;
}

cw_status cwi_slice_files_look(const cwi_slice_kind *kind, const cwi_input *in,
                               cwi_planes *planes, const cw_read_desc *desc, cwi_names *files,
                               cw_error *err)
{
    cwi_damaged damaged = {0};
    cw_status st = CW_OK;
    size_t kept = 0;
    for (size_t i = 0; st == CW_OK && i < files->count; i++) {
        char *name = files->items[i];
        cw_error why = {0};
        planes->box.done = (double)i / (double)files->count;
        st = look_into(kind, in, name, kept == 0, &why);
        if (cwi_is_damage(st)) {
            st = leave_out(planes, desc, files->count, &damaged, name, &why, err);
            continue;
        }
        if (st != CW_OK)
            cwi_fail(err, st, "%s", why.message);
        else if (files->count > 1 && (st = kind->compare(kind->user, err)) != CW_OK)
            cwi_fail_in(err, st, name);
        files->items[i] = files->items[kept];
        files->items[kept++] = name; /* those left out gather at the end */
    }
    if (st == CW_OK && kept == 0)
        st = cwi_fail(err, damaged.items[0].status, "%s: %s", damaged.items[0].name,
                      damaged.items[0].reason);
    if (st == CW_OK)
        cwi_damaged_note(&damaged, "left out, because they cannot be read", desc);
    cwi_damaged_free(&damaged);
    while (st == CW_OK && files->count > kept)
        cwi_free(files->items[--files->count]);
    return st;
}

/* Finds the positions: the numbers in which names differ, else 0, 1, 2 ... */
static cw_status find_positions(const cwi_names *files, const cw_read_desc *desc,
                                double *positions, cw_error *err)
{
    if (!cwi_files_numbers(files, positions)) {
        for (size_t i = 0; i < files->count; i++)
            positions[i] = (double)i;
        cwi_note(desc, "the files' names do not differ by one number alone: taken in their "
                       "order, and whether any is missing is not known");
    }
    for (size_t i = 1; i < files->count; i++)
        if (positions[i] == positions[i - 1])
            return cwi_fail(err, CW_ERR_UNSAFE, "'%.80s' and '%.80s' have the same number",
                            files->items[i - 1], files->items[i]);
    return CW_OK;
}

static cw_status lay_slices(const cwi_names *files, const cw_read_desc *desc, cwi_slices *laid,
                            cw_error *err)
{
    double *positions = cwi_alloc_array(files->count, sizeof *positions);
    if (!positions)
        return cwi_fail_memory(err);
    cw_status st = find_positions(files, desc, positions, err);
    if (st == CW_OK)
        st = cwi_slices_lay(positions, files->count, "in their numbers", desc->gaps, laid, err);
    cwi_free(positions);
    if (st == CW_OK && laid->finding[0])
        cwi_note(desc, "%s: %s", laid->finding,
                 desc->gaps == CW_GAPS_ALLOW ? "taken as if they were even"
                                             : "interpolated to even ones");
    return st;
}

cw_status cwi_slice_files_stack(const cwi_names *files, const cw_read_desc *desc,
                                cwi_stack *stack, size_t *count, cw_error *err)
{
    cwi_slices laid = {0};
    cw_status st = lay_slices(files, desc, &laid, err);
    if (st == CW_OK)
        st = cwi_stack_reserve(stack, files->count, laid.count, err);
    for (size_t i = 0; st == CW_OK && i < files->count; i++)
        stack->planes[i].file = i;
    for (size_t k = 0; st == CW_OK && k < laid.count; k++) {
        const cwi_slice *from = &laid.items[k];
        stack->slots[k] =
            (cwi_slot){.slice = k, .low = from->low, .high = from->high, .t = from->t};
    }
    *count = laid.count;
    cwi_slices_free(&laid);
    return st;
}
