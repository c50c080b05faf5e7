/* Keeps the list of files that were opened last, one path a line, the latest first. */
#define _GNU_SOURCE /* realpath, strdup */
#include "cli/session/view.h"

#include "core/base/text.h"
#include "core/files/atomic_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Finds a file of ours in the user's folder for state. false: there is no such folder. */
static bool find_state_file(char path[VIEW_PATH])
{
    const char *home = getenv("HOME"), *state = getenv("XDG_STATE_HOME");
    const bool has_state = state && *state;
    if (!has_state && !(home && *home))
        return false;
    return snprintf(path, VIEW_PATH, "%s%s/cubewright/recent", has_state ? state : home,
                    has_state ? "" : "/.local/state") < VIEW_PATH;
}

void view_start_recent(view *v, const char *named)
{
    char line[VIEW_PATH];
    const bool is_named = named && strcmp(named, "none") != 0;
    v->recent.count = 0;
    if ((named && !is_named) || (!named && v->is_hidden))
        return;
    if (is_named)
        snprintf(v->recent.path, sizeof v->recent.path, "%s", named);
    else if (!find_state_file(v->recent.path))
        return;
    FILE *in = fopen(v->recent.path, "rb");
    while (in && v->recent.count < VIEW_RECENT && fgets(line, sizeof line, in)) {
        line[strcspn(line, "\n")] = '\0';
        if (*line && (v->recent.files[v->recent.count] = strdup(line)))
            v->recent.count++;
    }
    if (in)
        fclose(in);
}

void view_end_recent(view *v)
{
    for (size_t n = 0; n < v->recent.count; n++)
        free(v->recent.files[n]);
    v->recent.count = 0;
}

/* Makes the folders above a file. What fails is seen when the file is written. */
static void make_folders(const char *path)
{
    char folder[VIEW_PATH];
    snprintf(folder, sizeof folder, "%s", path);
    for (char *slash = strchr(folder + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        (void)mkdir(folder, 0700);
        *slash = '/';
    }
}

/* A list that cannot be written is no reason to disturb anybody. */
static void save_recent(const view *v)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    for (size_t n = 0; out && n < v->recent.count; n++)
        fprintf(out, "%s\n", v->recent.files[n]);
    make_folders(v->recent.path);
    if (out && cwi_text_close(out, &text)) {
        (void)!cwi_outfile_save(v->recent.path, text, size, NULL);
        free(text);
    }
}

void view_remember_file(view *v)
{
    char whole[VIEW_PATH];
    if (!v->recent.path[0] || v->document.file_count != 1 ||
        !realpath(v->document.path, whole) || strchr(whole, '\n'))
        return;
    size_t at = 0;
    while (at < v->recent.count && strcmp(v->recent.files[at], whole) != 0)
        at++;
    char *path = at < v->recent.count ? v->recent.files[at] : strdup(whole);
    if (!path)
        return;
    if (at == v->recent.count && at == VIEW_RECENT)
        free(v->recent.files[--at]);
    v->recent.count = at < v->recent.count ? v->recent.count : at + 1;
    memmove(v->recent.files + 1, v->recent.files, at * sizeof *v->recent.files);
    v->recent.files[0] = path;
    save_recent(v);
}
