/* Arrays in temporary files without a name, for work that does not fit memory. */
#ifndef CORE_BASE_FILE_ARRAYS_H
#define CORE_BASE_FILE_ARRAYS_H

#include <cubewright/core.h>

#include <pthread.h>
#include <stdatomic.h>
#include <sys/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An array: the mapping of a file that is closed, and ends with it. */
typedef struct cwi_file_array {
    char *memory;
    size_t bytes;
} cwi_file_array;

/* All arrays of a process. Set the lock and max_resident, and zero the rest. */
typedef struct cwi_file_arrays {
    pthread_mutex_t lock; /* for all that is not atomic */
    atomic_size_t count;
    atomic_size_t bytes;   /* of all arrays */
    cwi_file_array *items; /* rising by address */
    size_t capacity;
    char *folder;    /* of new arrays; NULL: none are made */
    pid_t owner;     /* process that may make arrays: those that it forked share its files */
    size_t resident; /* bytes of files in memory before the first array: of the program */
    size_t (*max_resident)(void); /* returns the bytes of arrays that may be in memory */
    bool is_watched;              /* a thread trims while there are arrays */
} cwi_file_arrays;

/* Sets the folder of the files of new arrays; NULL: none are made from now on.
 * Returns CW_ERR_OUTPUT: no file can be made there; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_file_arrays_open(cwi_file_arrays *files, const char *folder,
                                            cw_error *err);

/* Returns true if arrays can be made. */
bool cwi_file_arrays_are_open(const cwi_file_arrays *files);

/* Makes an array of zeros, on a page's boundary, whose room on the disk is reserved. When the disk has
 * no room, it returns NULL and sets *error to a number of errno. */
void *cwi_file_array_new(cwi_file_arrays *files, size_t bytes, int *error);

/* Frees an array. Returns false, and does nothing, for memory that is not in a file. */
bool cwi_file_array_free(cwi_file_arrays *files, const void *memory);

/* Returns the size of an array; 0 for memory that is not in a file. */
size_t cwi_file_array_size(cwi_file_arrays *files, const void *memory);

/* Leaves all arrays to their files if more than max_resident() bytes of them are in memory. They are read
 * again where they are used, by any thread at any time. A thread does so every other millisecond; one
 * that works on arrays may do it by itself, so as not to depend on that. */
void cwi_file_arrays_trim(cwi_file_arrays *files);

/* Tells that this process was forked: no thread trims in it. */
void cwi_file_arrays_forked(cwi_file_arrays *files);

/* Returns the bytes that a folder's disk has room for; SIZE_MAX: unknown. */
size_t cwi_folder_room(const char *folder);

#ifdef __cplusplus
}
#endif

#endif
