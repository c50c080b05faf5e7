/* Widgets, panels and drawing, by Dear ImGui; and the module's table of functions. Labels go
 * into ImGui as they are; where each widget landed is noted for find(). */
#include "viewer/window/ui_internal.h"

#include "core/base/module.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <cfloat>

namespace
{

ImVec2 point(double x, double y)
{
    return ImVec2(static_cast<float>(x), static_cast<float>(y));
}

ImU32 packed(const cwi_ui_color c)
{
    return ImGui::ColorConvertFloat4ToU32(ImVec4(c[0], c[1], c[2], c[3]));
}

/* ---- where widgets are ---- */

/* Notes the visible part of a widget's rectangle. */
void note_rect(cwi_ui *ui, const char *label, ImRect r)
{
    r.ClipWith(ImGui::GetCurrentWindow()->ClipRect);
    if (r.Min.x >= r.Max.x || r.Min.y >= r.Max.y)
        return;
    const cwi_ui_rect rect = {r.Min.x, r.Min.y, r.GetWidth(), r.GetHeight()};
    cwi_ui_widget_rects_add(ui, label, &rect);
}

/* Notes the widget before, without the label at its side. */
void note(cwi_ui *ui, const char *label)
{
    if (!ImGui::GetCurrentWindow()->SkipItems)
        note_rect(ui, label, ImGui::GetCurrentContext()->LastItemData.NavRect);
}

/* Notes a widget that is used in one go. */
bool used(cwi_ui *ui, const char *label, bool is_used)
{
    note(ui, label);
    ui->is_ended = is_used;
    return is_used;
}

/* Notes a widget that is dragged or typed into. */
bool dragged(cwi_ui *ui, const char *label, bool is_used)
{
    note(ui, label);
    ui->is_ended = ImGui::IsItemDeactivatedAfterEdit();
    return is_used;
}

/* Leaves room for a widget's label at its side, in panels that have a width of their own. */
void leave_room(const char *label)
{
    const ImGuiWindow *window = ImGui::GetCurrentWindow();
    const ImGuiContext *g = ImGui::GetCurrentContext();
    if ((window->Flags & ImGuiWindowFlags_AlwaysAutoResize) ||
        (g->NextItemData.Flags & ImGuiNextItemDataFlags_HasWidth))
        return;
    const float all = ImGui::GetContentRegionAvail().x;
    const float beside = ImGui::CalcTextSize(label, nullptr, true).x;
    const float left = all - beside - ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::SetNextItemWidth(left < 0.35f * all   ? 0.35f * all
                            : left > 0.62f * all ? 0.62f * all
                                                 : left);
}

/* ---- drawing ---- */

/* Returns the list to draw into. Outside all panels ImGui would open one of its own. */
ImDrawList *list_of(const cwi_ui *ui, cwi_ui_layer layer)
{
    const bool in_panel =
        ui->depth > 0 && !(ui->panel_flags[cwi_ui_panel_at(ui)] & CWI_UI_GONE);
    if (layer == CWI_UI_FRONT)
        return ImGui::GetForegroundDrawList();
    return layer == CWI_UI_PANEL && in_panel ? ImGui::GetWindowDrawList()
                                             : ImGui::GetBackgroundDrawList();
}

void show(cwi_ui *ui, int slot, const cwi_ui_rect *w)
{
    if (slot < 0 || slot >= CWI_UI_SLOTS || !ui->pictures[slot].texture)
        return;
    const auto texture =
        reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(ui->pictures[slot].texture));
    list_of(ui, CWI_UI_PANEL)
        ->AddImage(texture, point(w->x, w->y), point(w->x + w->width, w->y + w->height));
}

/* Draws a line without AddLine(), which moves lines by half a pixel. */
void line(cwi_ui *ui, cwi_ui_layer layer, double x0, double y0, double x1, double y1,
          const cwi_ui_color color, double thickness)
{
    ImDrawList *list = list_of(ui, layer);
    list->PathLineTo(point(x0, y0));
    list->PathLineTo(point(x1, y1));
    list->PathStroke(packed(color), 0, static_cast<float>(thickness));
}

void box(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *r, const cwi_ui_color color,
         bool filled)
{
    const ImVec2 a = point(r->x, r->y), b = point(r->x + r->width, r->y + r->height);
    if (filled)
        list_of(ui, layer)->AddRectFilled(a, b, packed(color));
    else
        list_of(ui, layer)->AddRect(a, b, packed(color));
}

void blend(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *r, const cwi_ui_color left,
           const cwi_ui_color right)
{
    const ImU32 l = packed(left), m = packed(right);
    list_of(ui, layer)->AddRectFilledMultiColor(
        point(r->x, r->y), point(r->x + r->width, r->y + r->height), l, m, m, l);
}

void polygon(cwi_ui *ui, cwi_ui_layer layer, const double *points, size_t count,
             const cwi_ui_color color, bool filled)
{
    ImDrawList *list = list_of(ui, layer);
    for (size_t n = 0; n < count; n++)
        list->PathLineTo(point(points[2 * n], points[2 * n + 1]));
    if (filled)
        list->PathFillConvex(packed(color));
    else
        list->PathStroke(packed(color), 0, static_cast<float>(ui->scale));
}

void disc(cwi_ui *ui, cwi_ui_layer layer, double x, double y, double radius,
          const cwi_ui_color color, bool filled)
{
    const auto r = static_cast<float>(radius);
    if (filled)
        list_of(ui, layer)->AddCircleFilled(point(x, y), r, packed(color));
    else
        list_of(ui, layer)->AddCircle(point(x, y), r, packed(color), 0,
                                      static_cast<float>(ui->scale));
}

void write(cwi_ui *ui, cwi_ui_layer layer, double x, double y, const cwi_ui_color color,
           const char *text)
{
    list_of(ui, layer)->AddText(point(x, y), packed(color), text);
}

void text_size(cwi_ui *, const char *text, double size[2])
{
    const ImVec2 s = ImGui::CalcTextSize(text);
    size[0] = s.x;
    size[1] = s.y;
}

void clip_begin(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *r)
{
    list_of(ui, layer)->PushClipRect(point(r->x, r->y),
                                     point(r->x + r->width, r->y + r->height), true);
}

void clip_end(cwi_ui *ui, cwi_ui_layer layer)
{
    list_of(ui, layer)->PopClipRect();
}

/* ---- panels ---- */

/* Places a panel. A width or height of 0 follows the panel's content, up to the window's
 * border. */
void place_panel(const cwi_ui *ui, const char *title, const cwi_ui_rect *r, bool fixed)
{
    const ImGuiCond when = fixed ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    const ImGuiWindow *window = ImGui::FindWindowByName(title);
    ImGui::SetNextWindowPos(point(r->x, r->y), when);
    const double top = window && !fixed ? static_cast<double>(window->Pos.y) : r->y;
    const double max_height = static_cast<double>(ui->input.height) - top - 6 * ui->scale;
    ImGui::SetNextWindowSizeConstraints(point(0, 0),
                                        point(FLT_MAX, max_height > 60 ? max_height : 60));
    if (fixed || (r->width > 0 && r->height > 0)) {
        ImGui::SetNextWindowSize(point(r->width, r->height), when);
    } else if (r->width > 0 || r->height > 0) { /* the other is the user's */
        const ImVec2 now = window ? window->SizeFull : point(r->width, r->height);
        ImGui::SetNextWindowSize(ImVec2(r->width > 0 ? now.x : 0, r->height > 0 ? now.y : 0));
    }
}

/* Places a panel at the right border, as high as told. Its left border can be dragged. */
void dock_panel(const cwi_ui *ui, const cwi_ui_rect *r)
{
    const double min_width = CWI_UI_DOCKED_MIN * ui->scale,
                 max_width = CWI_UI_DOCKED_MAX * static_cast<double>(ui->input.width);
    const double narrowest = min_width < max_width ? min_width : max_width;
    ImGui::SetNextWindowPos(point(r->x + r->width, r->y), ImGuiCond_Always, ImVec2(1, 0));
    ImGui::SetNextWindowSize(point(r->width, r->height), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSizeConstraints(point(narrowest, r->height),
                                        point(max_width, r->height));
}

/* Places a panel upon the lower border, as high as its content. */
void place_strip(const cwi_ui_rect *r)
{
    ImGui::SetNextWindowPos(point(r->x, r->y + r->height), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::SetNextWindowSize(point(r->width, 0));
}

bool begin_modal(const cwi_ui *ui, const char *title, const cwi_ui_rect *r, bool *open)
{
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse;
    if (!ImGui::IsPopupOpen(title))
        ImGui::OpenPopup(title);
    ImGui::SetNextWindowPos(point(static_cast<double>(ui->input.width) / 2,
                                  static_cast<double>(ui->input.height) / 2),
                            ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(point(r ? r->width : 0, r ? r->height : 0));
    return ImGui::BeginPopupModal(title, open, flags);
}

ImGuiWindowFlags flags_of(const cwi_ui *ui, unsigned flags, const cwi_ui_rect *r)
{
    ImGuiWindowFlags f = ImGuiWindowFlags_NoSavedSettings;
    if (!ui->by_keyboard)
        f |= ImGuiWindowFlags_NoNav;
    if (flags & CWI_UI_FIXED)
        f |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse;
    if (flags & CWI_UI_DOCKED)
        f |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse;
    if (flags & (CWI_UI_BARE | CWI_UI_STRIP))
        f |= ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
             ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus;
    if (flags & CWI_UI_BARE)
        f |= ImGuiWindowFlags_AlwaysAutoResize;
    else if (r->width <= 0 && r->height <= 0)
        f |= ImGuiWindowFlags_AlwaysAutoResize;
    return f;
}

bool panel_begin(cwi_ui *ui, const char *title, const cwi_ui_rect *rect, unsigned flags,
                 bool *open)
{
    const cwi_ui_rect nothing = {0, 0, 0, 0};
    const cwi_ui_rect *r = rect ? rect : &nothing;
    cwi_ui_panel_enter(ui, title, flags);
    if (flags & CWI_UI_MODAL) {
        const bool is_open = begin_modal(ui, title, rect, open);
        if (!is_open)
            ui->panel_flags[cwi_ui_panel_at(ui)] = CWI_UI_MODAL | CWI_UI_GONE;
        return is_open;
    }
    cwi_ui_rect where = *r;
    if (flags & CWI_UI_BARE) {
        where.width = where.height = 0;
        ImGui::SetNextWindowBgAlpha(0.55f);
    }
    if (flags & CWI_UI_DOCKED)
        dock_panel(ui, r);
    else if (flags & CWI_UI_STRIP)
        place_strip(r);
    else
        place_panel(ui, title, &where, (flags & (CWI_UI_FIXED | CWI_UI_BARE)) != 0);
    return ImGui::Begin(title, open, flags_of(ui, flags, r));
}

/* Notes a panel's closing button, where ImGui draws it. */
void note_close(cwi_ui *ui, const ImGuiWindow *window)
{
    const ImVec2 padding = ImGui::GetStyle().FramePadding;
    const ImRect bar = window->TitleBarRect();
    const float side = ImGui::GetFontSize();
    const cwi_ui_rect rect = {bar.Max.x - padding.x - side, bar.Min.y + padding.y, side, side};
    cwi_ui_widget_rects_add(ui, "close", &rect);
}

void leave_section(cwi_ui *ui)
{
    bool *in_section = &ui->in_section[cwi_ui_panel_at(ui)];
    if (*in_section)
        ImGui::PopID();
    *in_section = false;
}

void panel_end(cwi_ui *ui)
{
    const int at = cwi_ui_panel_at(ui);
    const unsigned flags = ui->panel_flags[at];
    char title[CWI_UI_NAME_SIZE];
    cwi_ui_label(title, ui->panel[at]);
    leave_section(ui);
    if (!(flags & CWI_UI_GONE)) {
        const ImGuiWindow *window = ImGui::GetCurrentWindow();
        const cwi_ui_rect rect = {window->Pos.x, window->Pos.y, window->Size.x, window->Size.y};
        if (window->HasCloseButton)
            note_close(ui, window);
        cwi_ui_panel_leave(ui);
        cwi_ui_widget_rects_add(ui, title, &rect);
        if (flags & CWI_UI_MODAL)
            ImGui::EndPopup();
        else
            ImGui::End();
    } else {
        cwi_ui_panel_leave(ui);
    }
}

/* Opens a section. Widgets of two sections may have the same label, or that of a section's
 * title. ImGui would confuse them, and end the program where one is typed into and the other is
 * clicked. */
bool section(cwi_ui *ui, const char *title, bool open_at_first)
{
    leave_section(ui);
    const bool open = ImGui::CollapsingHeader(
        title, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
    used(ui, title, ImGui::IsItemToggledOpen());
    ImGui::PushID(title);
    ui->in_section[cwi_ui_panel_at(ui)] = true;
    return open;
}

/* ---- widgets ---- */

/* Writes wrapped text. A panel as wide as its content would be as narrow as the longest
 * word. */
void text(cwi_ui *ui, const char *words)
{
    const ImGuiWindow *window = ImGui::GetCurrentWindow();
    const bool grows = (window->Flags & ImGuiWindowFlags_AlwaysAutoResize) ||
                       (window->AutoFitFramesX > 0 && window->Size.x <= 0);
    ImGui::PushTextWrapPos(grows ? ImGui::GetCursorPosX() + 36 * ImGui::GetFontSize() : 0);
    ImGui::TextUnformatted(words);
    ImGui::PopTextWrapPos();
    used(ui, words, false);
}

bool button(cwi_ui *ui, const char *label)
{
    const bool is_used = ImGui::Button(label);
    return used(ui, label, is_used);
}

bool check(cwi_ui *ui, const char *label, bool *on)
{
    const bool is_used = ImGui::Checkbox(label, on);
    return used(ui, label, is_used);
}

bool choose(cwi_ui *ui, const char *const *names, size_t count, size_t *chosen)
{
    bool is_used = false;
    for (size_t n = 0; n < count; n++) {
        if (names[n][0] == CWI_UI_HEADING[0]) {
            ImGui::TextDisabled("%s", names[n] + 1);
            continue;
        }
        ImGui::PushID(static_cast<int>(n));
        if (ImGui::Selectable(names[n], n == *chosen)) {
            is_used = n != *chosen;
            *chosen = n;
        }
        if (n == *chosen) {
            ImGui::SetItemDefaultFocus();
            if (ImGui::IsWindowAppearing())
                ImGui::SetScrollHereY();
        }
        note(ui, names[n]);
        ImGui::PopID();
    }
    return is_used;
}

bool choice(cwi_ui *ui, const char *label, const char *const *names, size_t count,
            size_t *chosen)
{
    bool is_used = false;
    leave_room(label);
    const bool open = ImGui::BeginCombo(label, *chosen < count ? names[*chosen] : "",
                                        ImGuiComboFlags_HeightLarge);
    if (open) {
        cwi_ui_panel_enter(ui, label, 0);
        is_used = choose(ui, names, count, chosen);
        cwi_ui_panel_leave(ui);
        ImGui::EndCombo();
    }
    return used(ui, label, is_used);
}

bool slide(cwi_ui *ui, const char *label, double *value, double low, double high,
           const char *format, ImGuiSliderFlags flags)
{
    leave_room(label);
    const bool is_used = ImGui::SliderScalar(label, ImGuiDataType_Double, value, &low, &high,
                                             format, flags | ImGuiSliderFlags_AlwaysClamp);
    return dragged(ui, label, is_used);
}

bool slider(cwi_ui *ui, const char *label, double *value, double low, double high,
            const char *format)
{
    return slide(ui, label, value, low, high, format, 0);
}

bool log_slider(cwi_ui *ui, const char *label, double *value, double low, double high,
                const char *format)
{
    return slide(ui, label, value, low, high, format, ImGuiSliderFlags_Logarithmic);
}

bool number(cwi_ui *ui, const char *label, double *value, double per_pixel, const char *format)
{
    leave_room(label);
    const bool is_used =
        ImGui::DragScalar(label, ImGuiDataType_Double, value, static_cast<float>(per_pixel),
                          nullptr, nullptr, format);
    return dragged(ui, label, is_used);
}

/* Edits a colour. Its place is that of the coloured square: clicks on the label do nothing. */
bool color(cwi_ui *ui, const char *label, float rgb[3])
{
    const bool is_used = ImGui::ColorEdit3(
        label, rgb, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoOptions);
    const ImVec2 corner = ImGui::GetItemRectMin();
    const float side = ImGui::GetFrameHeight();
    note_rect(ui, label, ImRect(corner, ImVec2(corner.x + side, corner.y + side)));
    ui->is_ended = ImGui::IsItemDeactivatedAfterEdit();
    return is_used;
}

bool input(cwi_ui *ui, const char *label, char *words, size_t size)
{
    leave_room(label);
    const bool is_used =
        ImGui::InputText(label, words, size, ImGuiInputTextFlags_EnterReturnsTrue);
    return dragged(ui, label, is_used);
}

void area(cwi_ui *ui, const char *label, double width, double height, cwi_ui_area *a)
{
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const double all = static_cast<double>(ImGui::GetContentRegionAvail().x);
    const double w = width > 0 ? width : all > 1 ? all : 1, h = height > 1 ? height : 1;
    ImGui::InvisibleButton(label, point(w, h));
    *a = cwi_ui_area{};
    a->rect = {corner.x, corner.y, w, h};
    a->x = ui->input.x - a->rect.x;
    a->y = ui->input.y - a->rect.y;
    a->over = ImGui::IsItemHovered();
    a->is_down = ImGui::IsItemActive();
    a->pressed = ImGui::IsItemActivated();
    a->lifted = ImGui::IsItemDeactivated();
    a->twice = a->pressed && ui->input.twice[CWI_UI_LEFT];
    a->right = a->over && ui->input.pressed[CWI_UI_RIGHT];
    used(ui, label, a->lifted);
}

void progress(cwi_ui *ui, double fraction, const char *words)
{
    ImGui::ProgressBar(static_cast<float>(fraction), ImVec2(-FLT_MIN, 0), words ? words : "");
    used(ui, words ? words : "", false);
}

void same_line(cwi_ui *)
{
    ImGui::SameLine();
}

void rule(cwi_ui *)
{
    ImGui::Separator();
}

void width(cwi_ui *, double width)
{
    ImGui::SetNextItemWidth(static_cast<float>(width));
}

void disable(cwi_ui *, bool on)
{
    if (on)
        ImGui::BeginDisabled();
    else
        ImGui::EndDisabled();
}

/* Shows a tooltip once the mouse stays on the widget before. While something is dragged it would
 * cover that. */
void tip(cwi_ui *ui, const char *words)
{
    const double TIP_DELAY_S = 0.4;
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || ImGui::IsAnyMouseDown())
        return;
    const ImGuiContext *g = ImGui::GetCurrentContext();
    const double stayed = g->HoveredId ? static_cast<double>(g->HoveredIdTimer) : TIP_DELAY_S;
    if (stayed < TIP_DELAY_S) {
        ui->wake = TIP_DELAY_S - stayed + 0.01;
        return;
    }
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(30 * ImGui::GetFontSize());
    ImGui::TextUnformatted(words);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool changed(const cwi_ui *ui)
{
    return ui->is_ended;
}

/* ---- the bar ---- */

double bar_begin(cwi_ui *ui)
{
    ui->has_bar = ImGui::BeginMainMenuBar();
    return static_cast<double>(ImGui::GetFrameHeight());
}

void bar_end(cwi_ui *ui)
{
    if (ui->has_bar)
        ImGui::EndMainMenuBar();
    ui->has_bar = false;
}

bool menu_begin(cwi_ui *ui, const char *label)
{
    const bool open = ImGui::BeginMenu(label);
    if (open)
        cwi_ui_panel_enter(ui, label, 0);
    else
        note(ui, label);
    return open;
}

void menu_end(cwi_ui *ui)
{
    char label[CWI_UI_NAME_SIZE];
    cwi_ui_label(label, ui->panel[cwi_ui_panel_at(ui)]);
    cwi_ui_panel_leave(ui);
    ImGui::EndMenu();
    note(ui, label);
}

bool item(cwi_ui *ui, const char *label, const char *key, bool checked, bool enabled)
{
    const bool is_used = ImGui::MenuItem(label, key, checked, enabled);
    return used(ui, label, is_used);
}

} // namespace

extern "C" {
extern CW_API const cwi_ui_functions cwi_module_window;
const cwi_ui_functions cwi_module_window = {
    cwi_ui_open,
    cwi_ui_close,
    cwi_ui_name,
    cwi_ui_scale,
    cwi_ui_screen_seconds,
    cwi_ui_pending,
    cwi_ui_feed,
    cwi_ui_begin,
    cwi_ui_end,
    cwi_ui_grab,
    cwi_ui_screen_title,
    cwi_ui_screen_copy,
    cwi_ui_set_cursor,
    cwi_ui_imgui_theme,
    cwi_ui_imgui_focus,
    cwi_ui_imgui_focused,
    cwi_ui_keep,
    show,
    line,
    box,
    blend,
    polygon,
    disc,
    write,
    text_size,
    clip_begin,
    clip_end,
    panel_begin,
    panel_end,
    section,
    text,
    button,
    check,
    choice,
    slider,
    log_slider,
    number,
    color,
    input,
    area,
    progress,
    same_line,
    rule,
    width,
    disable,
    tip,
    changed,
    bar_begin,
    bar_end,
    menu_begin,
    menu_end,
    item,
    cwi_ui_widget_rects_find,
};
}
