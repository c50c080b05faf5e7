/* Files of a folder of slices that cannot be read: their names, and the reason. */
#ifndef FORMATS_VOLUME_DAMAGED_FILES_H
#define FORMATS_VOLUME_DAMAGED_FILES_H

#include <cubewright/formats.h>

typedef struct cwi_damaged_file {
    char name[104], reason[200];
    char owner[72]; /* UID of its series; empty: not known */
    cw_status status;
} cwi_damaged_file;

/* A zeroed list is empty. Free it with cwi_damaged_free(). */
typedef struct cwi_damaged {
    cwi_damaged_file *items;
    size_t count;
} cwi_damaged;

/* Returns true if a status says that one file is damaged, rather than that reading has to end. */
bool cwi_is_damage(cw_status status);

/* Adds a file.
 * owner  UID of its series; empty: not known */
CW_NODISCARD cw_status cwi_damaged_add(cwi_damaged *list, const char *name, const char *owner,
                                       const cw_error *reason, cw_error *err);
void cwi_damaged_free(cwi_damaged *list);

/* Notes the names and the first reason, if there are any files.
 * words  such as "left out, because they cannot be read" */
void cwi_damaged_note(const cwi_damaged *list, const char *words, const cw_read_desc *desc);

/* Fails with one of the files, and names the field that leaves such files out. */
cw_status cwi_damaged_fail(const cwi_damaged_file *file, cw_error *err);

/* Puts the file's name in front of its error, and that field behind it. */
cw_status cwi_fail_in_damaged(cw_error *err, cw_status status, const char *name);

#endif
