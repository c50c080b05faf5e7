/* Converts names of keys to numbers, and back. */
#include "viewer/window/ui_internal.h"

#include <stdio.h>
#include <string.h>

static const char *const named[] = {
    "Space", "Enter",  "Tab",      "Escape", "Backspace", "Delete", "Insert", "Home", "End",
    "Left",  "PageUp", "PageDown", "Right",  "Up",        "Down",   "F1",     "F2",   "F3",
    "F4",    "F5",     "F6",       "F7",     "F8",        "F9",     "F10",    "F11",  "F12"};

static const struct {
    const char *name;
    unsigned flag;
} modifiers_of[] = {{"Ctrl+", CWI_UI_CTRL}, {"Alt+", CWI_UI_ALT}, {"Shift+", CWI_UI_SHIFT}};

enum { NAMED = sizeof named / sizeof *named, FIRST_NAMED = 256, OTHER = 1 };

/* Returns true if a text is one character of UTF-8, whose length is given by its first byte. */
static bool is_one_character(const char *text)
{
    const unsigned char c = (unsigned char)*text;
    const size_t length = c == 0     ? 0
                          : c < 0x80 ? 1
                          : c < 0xc0 ? 0
                          : c < 0xe0 ? 2
                          : c < 0xf0 ? 3
                                     : 4;
    for (size_t n = 1; n < length; n++)
        if (((unsigned char)text[n] & 0xc0) != 0x80)
            return false;
    return length > 0 && text[length] == '\0';
}

static int number_of(const char *key)
{
    const unsigned char c = (unsigned char)*key;
    for (int n = 0; n < NAMED; n++)
        if (strcmp(key, named[n]) == 0)
            return FIRST_NAMED + n;
    if (!is_one_character(key) || c <= ' ' || c == 0x7f || (c >= 'a' && c <= 'z'))
        return 0; /* letters are capitals */
    return c < 0x80 ? c : OTHER;
}

int cwi_ui_key_number(const char *name, unsigned *modifiers)
{
    unsigned found = 0;
    for (int n = 0; n < 3; n++) {
        const size_t length = strlen(modifiers_of[n].name);
        if (strncmp(name, modifiers_of[n].name, length) == 0) {
            found |= modifiers_of[n].flag;
            name += length;
        }
    }
    if (modifiers)
        *modifiers = found;
    return number_of(name);
}

void cwi_ui_key_name(char name[CWI_UI_KEY_SIZE], unsigned modifiers, const char *key)
{
    snprintf(name, CWI_UI_KEY_SIZE, "%s%s%s%s", modifiers & CWI_UI_CTRL ? "Ctrl+" : "",
             modifiers & CWI_UI_ALT ? "Alt+" : "", modifiers & CWI_UI_SHIFT ? "Shift+" : "",
             key);
}
