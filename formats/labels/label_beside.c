/* Finds the table of labels beside a volume: a file of the same stem, in the same folder. */
#define _GNU_SOURCE /* close */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/input_file.h"
#include "formats/labels/label_file.h"

#include <cubewright/formats.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Ends of names, the most specific first. */
static const char *const suffixes[] = {".ctbl", ".ctab",     ".label", ".txt", "_semicolon.txt",
                                       ".csv",  "_dseg.tsv", ".tsv",   ".json"};
enum { SUFFIX_COUNT = sizeof suffixes / sizeof *suffixes, MAX_STEMS = 4 };

/* Lists the lengths of the stems of a name, the longest first: of a.seg.nrrd the whole, "a.seg"
 * and "a"; of a.nii.gz "a.nii" and "a". */
static size_t list_stems(const char *name, size_t lengths[MAX_STEMS])
{
    size_t count = 0, length = strlen(name);
    if (cwi_has_extension(name, ".gz"))
        length -= 3;
    lengths[count++] = length;
    size_t end = length > 0 ? length - 1 : 0;
    while (end > 0 && name[end] != '.')
        end--;
    if (end == 0)
        return count;
    lengths[count++] = end;
    if (end > 4 && strncmp(name + end - 4, ".seg", 4) == 0)
        lengths[count++] = end - 4;
    return count;
}

/* Returns true if an open file is a table of labels. Lines of a text may look like one by
 * chance, so such a file must be readable as a whole. */
static cw_status test_table(int fd, uint64_t size, bool is_text, bool *is_table, cw_error *err)
{
    cwi_label_file file;
    cw_label_table table = {0};
    cw_status st = cwi_label_file_open(&file, fd, size, err);
    const cwi_label_format *format = st == CW_OK ? cwi_label_format_of(&file) : NULL;
    if (format && is_text)
        st = format->read(&file, &table, err);
    cw_label_table_free(&table);
    cwi_label_file_close(&file);
    *is_table = format && st == CW_OK;
    return st == CW_ERR_NO_MEMORY ? st : CW_OK;
}

static cw_status test_name(const cwi_input *folder, const char *volume, const char *name,
                           bool *is_table, cw_error *err)
{
    uint64_t size;
    int fd;
    *is_table = false;
    if (strcmp(name, volume) == 0 ||
        cwi_input_open_side(folder, name, &fd, &size, NULL) != CW_OK)
        return CW_OK;
    cw_status st = test_table(fd, size, cwi_has_extension(name, ".txt"), is_table, err);
    close(fd);
    return st;
}

static cw_status print_path(const char *folder, size_t folder_length, const char *name,
                            size_t stem_length, const char *suffix, char **path, cw_error *err)
{
    size_t size;
    FILE *text = cwi_text_open(path, &size);
    if (text) {
        fwrite(folder, 1, folder_length, text);
        fwrite(name, 1, stem_length, text);
        fputs(suffix, text);
    }
    return cwi_text_close(text, path) ? CW_OK : cwi_fail_memory(err);
}

cw_status cw_label_table_beside(const char *volume_path, char **table_path, cw_error *err)
{
    CWI_REQUIRE(err, volume_path, table_path);
    const char *slash = strrchr(volume_path, '/');
    const char *name = slash ? slash + 1 : volume_path;
    const size_t folder_length = (size_t)(name - volume_path);
    size_t stems[MAX_STEMS];
    cwi_input folder = {0};
    char *folder_path = NULL;
    bool is_found = false;
    *table_path = NULL;
    const size_t stem_count = *name ? list_stems(name, stems) : 0;
    cw_status st =
        print_path(volume_path, folder_length, "", 0, slash ? "" : ".", &folder_path, err);
    if (st == CW_OK && cwi_input_open_folder(&folder, folder_path, NULL) != CW_OK)
        goto done;
    for (size_t n = 0; n < SUFFIX_COUNT * stem_count && st == CW_OK && !is_found; n++) {
        free(*table_path);
        st = print_path(volume_path, folder_length, name, stems[n % stem_count],
                        suffixes[n / stem_count], table_path, err);
        if (st == CW_OK)
            st = test_name(&folder, name, *table_path + folder_length, &is_found, err);
    }
done:
    if (!is_found) {
        free(*table_path);
        *table_path = NULL;
    }
    cwi_input_close(&folder);
    free(folder_path);
    return st;
}
