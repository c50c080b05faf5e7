/* Browses folders for files to open, with the folders first. */
#define _GNU_SOURCE /* scandir, strverscmp, strdup */
#include "cli/view/view.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool is_folder_in(const char *folder, const char *name)
{
    char path[VIEW_PATH];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static int is_plain(const struct dirent *e)
{
    return e->d_name[0] != '.';
}

static int by_version(const struct dirent **a, const struct dirent **b)
{
    return strverscmp((*a)->d_name, (*b)->d_name);
}

static void forget_entries(view_browser *b)
{
    for (size_t n = 0; n < b->count; n++)
        free(b->names[n]);
    free(b->names);
    b->names = NULL;
    b->count = 0;
}

void view_close_browser(view *v)
{
    forget_entries(&v->browser);
}

int view_scan(const char *folder, struct dirent ***entries)
{
    *entries = NULL;
    return scandir(folder, entries, is_plain, by_version);
}

void view_free_scan(struct dirent **entries, int count)
{
    for (int n = 0; n < count; n++)
        free(entries[n]);
    free(entries);
}

/* Folders end with a slash, and come first. */
static void list_folder(view_browser *b)
{
    struct dirent **entries;
    const int count = view_scan(b->folder, &entries);
    forget_entries(b);
    b->names = count > 0 ? calloc((size_t)count, sizeof *b->names) : NULL;
    for (int folders = 1; folders >= 0; folders--)
        for (int n = 0; n < count && b->names; n++) {
            const char *name = entries[n]->d_name;
            if (is_folder_in(b->folder, name) != (folders == 1))
                continue;
            char *line = malloc(strlen(name) + 2);
            if (line)
                sprintf(line, "%s%s", name, folders ? "/" : "");
            if (line)
                b->names[b->count++] = line;
        }
    view_free_scan(entries, count);
}

/* That of the file that is open, else where the program was started. */
static void begin_browsing(view *v)
{
    view_browser *b = &v->browser;
    const char *slash = v->path ? strrchr(v->path, '/') : NULL;
    if (b->folder[0])
        return;
    snprintf(b->folder, sizeof b->folder, "%.*s",
             slash && slash != v->path ? (int)(slash - v->path) : 1, slash ? v->path : ".");
    list_folder(b);
}

static void enter_folder(view_browser *b, const char *name)
{
    char path[VIEW_PATH], whole[VIEW_PATH];
    const int length = snprintf(path, sizeof path, "%s/%s", b->folder, name);
    if (length < 0 || (size_t)length >= sizeof path || !realpath(path, whole))
        return;
    snprintf(b->folder, sizeof b->folder, "%s", whole);
    list_folder(b);
}

static void choose_file(view *v, const char *name)
{
    view_browser *b = &v->browser;
    char path[VIEW_PATH], line[VIEW_PATH];
    const size_t length = strlen(name);
    if (length && name[length - 1] == '/') {
        snprintf(line, sizeof line, "%.*s", (int)length - 1, name);
        enter_folder(b, line);
        return;
    }
    if (snprintf(path, sizeof path, "%s/%s", b->folder, name) < (int)sizeof path)
        view_ask_open(v, path);
    v->shown.files = false;
}

void view_browse(view *v)
{
    view_browser *b = &v->browser;
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {40 * scale, 50 * scale, 460 * scale,
                              fmax(120, (double)v->height - 120 * scale)};
    begin_browsing(v);
    size_t chosen = b->count;
    if (v->ui->panel_begin(v->window, "Open", &rect, 0, &v->shown.files)) {
        v->ui->text(v->window, b->folder);
        const bool up = v->ui->button(v->window, "Up");
        v->ui->same_line(v->window);
        if (v->ui->button(v->window, "All of this folder")) {
            view_ask_open(v, b->folder);
            v->shown.files = false;
        }
        v->ui->tip(v->window, "Open slices, or the steps of a time series");
        v->ui->rule(v->window);
        for (size_t n = 0; n < b->count; n++)
            if (v->ui->item(v->window, b->names[n], NULL, false, true))
                chosen = n;
        if (up)
            enter_folder(b, "..");
        else if (chosen < b->count)
            choose_file(v, b->names[chosen]);
    }
    v->ui->panel_end(v->window);
    if (!v->shown.files)
        b->folder[0] = '\0'; /* looked up again next time */
}
