/* Runs Dear ImGui: its context, fonts and colours, the input passed to it, and its frames.
 * Nothing here throws, and memory is allocated by malloc. */
#include "viewer/window/ui_internal.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cfloat>
#include <cstdio>
#include <dlfcn.h>
#include <unistd.h>

namespace
{

const char letters[] = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

/* Latin, Greek and Cyrillic; dashes, primes; superscripts; arrows; signs of mathematics;
 * squares, triangles and circles; ticks. */
const ImWchar ranges[] = {0x20,   0x24f,  0x370,  0x52f,  0x2010, 0x2044,
                          0x2070, 0x209f, 0x2190, 0x21ff, 0x2200, 0x22ff,
                          0x25a0, 0x25ff, 0x2713, 0x2717, 0};

/* Colours of one theme. Letters have a contrast of at least 4.5 to 1 on all that they stand on:
 * test_ui measures it. */
struct palette {
    float panel, popup, bar, title, active_title; /* grey levels of backgrounds */
    float frame, hovered_frame, active_frame, button, header;
    float text, faint_text, border, grip;
    ImVec4 accent, strong_accent;     /* marks */
    float hovered, pressed, selected; /* opacities of the accent on a background */
};

const palette palettes[] = {
    /* CWI_UI_DARK */
    {0.115f, 0.135f, 0.135f, 0.15f, 0.19f, 0.20f, 0.25f, 0.29f, 0.25f, 0.185f, 0.92f, 0.62f,
     0.30f, 0.35f, ImVec4(0.34f, 0.63f, 0.90f, 1), ImVec4(0.50f, 0.76f, 1, 1), 0.45f, 0.50f,
     0.45f},
    /* CWI_UI_LIGHT */
    {0.95f, 0.97f, 0.90f, 0.88f, 0.82f, 0.86f, 0.82f, 0.78f, 0.82f, 0.88f, 0.10f, 0.38f, 0.62f,
     0.60f, ImVec4(0.10f, 0.42f, 0.75f, 1), ImVec4(0.05f, 0.33f, 0.65f, 1), 0.30f, 0.40f,
     0.35f}};

/* Returns a grey with a touch of blue, which bright ones need less of. */
ImVec4 gray(float value, float alpha = 1)
{
    const float tint = 0.06f * (1 - value);
    return ImVec4(value * (1 - tint), value * (1 - tint / 3), value * (1 + tint), alpha);
}

ImVec4 faded(const ImVec4 &color, float alpha)
{
    return ImVec4(color.x, color.y, color.z, alpha);
}

void color_backgrounds(const palette &p, ImVec4 *c)
{
    c[ImGuiCol_WindowBg] = gray(p.panel, 0.96f);
    c[ImGuiCol_PopupBg] = gray(p.popup, 0.98f);
    c[ImGuiCol_MenuBarBg] = gray(p.bar);
    c[ImGuiCol_TitleBg] = gray(p.title);
    c[ImGuiCol_TitleBgActive] = gray(p.active_title);
    c[ImGuiCol_TitleBgCollapsed] = gray(p.title, 0.9f);
    c[ImGuiCol_ModalWindowDimBg] = ImVec4(0, 0, 0, 0.5f);
    c[ImGuiCol_Border] = gray(p.border, 0.7f);
    c[ImGuiCol_Separator] = gray(p.border, 0.7f);
    c[ImGuiCol_ScrollbarBg] = ImVec4(0, 0, 0, 0);
}

void color_widgets(const palette &p, ImVec4 *c)
{
    c[ImGuiCol_Text] = gray(p.text);
    c[ImGuiCol_TextDisabled] = gray(p.faint_text);
    c[ImGuiCol_TextSelectedBg] = faded(p.accent, p.selected);
    c[ImGuiCol_FrameBg] = gray(p.frame);
    c[ImGuiCol_FrameBgHovered] = gray(p.hovered_frame);
    c[ImGuiCol_FrameBgActive] = gray(p.active_frame);
    c[ImGuiCol_CheckMark] = p.accent;
    c[ImGuiCol_SliderGrab] = faded(p.accent, 0.55f); /* numbers stand on it */
    c[ImGuiCol_SliderGrabActive] = faded(p.strong_accent, 0.60f);
    c[ImGuiCol_Button] = gray(p.button);
    c[ImGuiCol_ButtonHovered] = faded(p.accent, p.hovered);
    c[ImGuiCol_ButtonActive] = faded(p.accent, p.pressed);
    c[ImGuiCol_Header] = gray(p.header);
    c[ImGuiCol_HeaderHovered] = faded(p.accent, p.hovered);
    c[ImGuiCol_HeaderActive] = faded(p.accent, p.pressed);
    c[ImGuiCol_PlotHistogram] = faded(p.accent, 0.40f); /* bars of progress */
    c[ImGuiCol_ResizeGrip] = gray(p.grip, 0.6f);
    c[ImGuiCol_ResizeGripHovered] = faded(p.accent, 0.6f);
    c[ImGuiCol_ResizeGripActive] = p.accent;
    c[ImGuiCol_ScrollbarGrab] = gray(p.grip);
    c[ImGuiCol_NavHighlight] = p.strong_accent;
}

void color_all(cwi_ui_theme theme)
{
    const palette &p = palettes[theme];
    ImVec4 *colors = ImGui::GetStyle().Colors;
    if (theme == CWI_UI_LIGHT)
        ImGui::StyleColorsLight();
    else
        ImGui::StyleColorsDark();
    color_backgrounds(p, colors);
    color_widgets(p, colors);
}

void style_all(float scale)
{
    ImGuiStyle &s = ImGui::GetStyle();
    color_all(CWI_UI_DARK);
    s.WindowRounding = s.PopupRounding = 6;
    s.FrameRounding = s.GrabRounding = s.ScrollbarRounding = 4;
    s.WindowPadding = ImVec2(10, 9);
    s.FramePadding = ImVec2(8, 4);
    s.ItemSpacing = ImVec2(8, 6);
    s.ItemInnerSpacing = ImVec2(6, 4);
    s.GrabMinSize = 11;
    s.ScrollbarSize = 12;
    s.WindowTitleAlign = ImVec2(0, 0.5f);
    s.WindowMenuButtonPosition = ImGuiDir_Right;
    s.DisabledAlpha = 0.45f;
    s.ScaleAllSizes(scale);
}

/* Adds the fonts. DejaVu's lines are 1.16 times as high as its letters' square: 15 pixels for
 * letters of 13. */
void add_letters(float scale)
{
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    ImFontConfig plain;
    plain.SizePixels = ImFloor(13 * scale);
    if (access(letters, R_OK) != 0 ||
        !fonts->AddFontFromFileTTF(letters, ImFloor(15 * scale + 0.5f), nullptr, ranges))
        fonts->AddFontDefault(&plain);
}

const char *paste(void *ui)
{
    return cwi_ui_screen_paste(static_cast<cwi_ui *>(ui));
}

void copy(void *ui, const char *text)
{
    cwi_ui_screen_copy(static_cast<cwi_ui *>(ui), text);
}

void name_keys(ImGuiIO &io)
{
    static const struct {
        ImGuiKey key;
        const char *name;
    } keys[] = {{ImGuiKey_Tab, "Tab"},
                {ImGuiKey_LeftArrow, "Left"},
                {ImGuiKey_RightArrow, "Right"},
                {ImGuiKey_UpArrow, "Up"},
                {ImGuiKey_DownArrow, "Down"},
                {ImGuiKey_PageUp, "PageUp"},
                {ImGuiKey_PageDown, "PageDown"},
                {ImGuiKey_Home, "Home"},
                {ImGuiKey_End, "End"},
                {ImGuiKey_Insert, "Insert"},
                {ImGuiKey_Delete, "Delete"},
                {ImGuiKey_Backspace, "Backspace"},
                {ImGuiKey_Space, "Space"},
                {ImGuiKey_Enter, "Enter"},
                {ImGuiKey_Escape, "Escape"},
                {ImGuiKey_A, "A"},
                {ImGuiKey_C, "C"},
                {ImGuiKey_V, "V"},
                {ImGuiKey_X, "X"},
                {ImGuiKey_Y, "Y"},
                {ImGuiKey_Z, "Z"}};
    for (const auto &k : keys)
        io.KeyMap[k.key] = cwi_ui_key_number(k.name, nullptr);
}

/* Returns true if libGL can be loaded: the backend looks for it, and prints when it is
 * missing. */
bool has_libgl()
{
    void *library = dlopen("libGL.so.1", RTLD_LAZY | RTLD_LOCAL);
    if (library)
        dlclose(library);
    return library != nullptr;
}

void tell_mouse(const cwi_ui *ui, ImGuiIO &io)
{
    const bool somewhere = ui->has_mouse && ui->input.x >= 0 && ui->input.y >= 0;
    bool held = false;
    for (int b = 0; b < CWI_UI_BUTTONS; b++) {
        io.MouseDown[b] = ui->input.down[b]; /* ImGui counts as we do */
        held = held || ui->input.down[b];
    }
    io.MousePos = somewhere || held
                      ? ImVec2(static_cast<float>(ui->input.x), static_cast<float>(ui->input.y))
                      : ImVec2(-FLT_MAX, -FLT_MAX);
    io.MouseWheel = static_cast<float>(ui->input.wheel);
}

void tell_keys(const cwi_ui *ui, ImGuiIO &io)
{
    for (bool &down : io.KeysDown)
        down = false;
    const bool is_use =
        ui->by_keyboard && !io.WantTextInput && ui->key == cwi_ui_key_number("Enter", nullptr);
    if (ui->key > 0) /* Enter uses a widget as Space does */
        io.KeysDown[is_use ? cwi_ui_key_number("Space", nullptr) : ui->key] = true;
    io.KeyCtrl = (ui->input.modifiers & CWI_UI_CTRL) != 0;
    io.KeyShift = (ui->input.modifiers & CWI_UI_SHIFT) != 0;
    io.KeyAlt = (ui->input.modifiers & CWI_UI_ALT) != 0;
}

bool is_modal(const ImGuiPopupData &popup)
{
    return popup.Window && (popup.Window->Flags & ImGuiWindowFlags_Modal);
}

/* Closes by Escape what a click outside would close; then nothing else receives the key. */
void shut_by_escape(cwi_ui *ui)
{
    ImGuiContext &g = *ui->imgui;
    const int open = g.OpenPopupStack.Size;
    if (open == 0 || is_modal(g.OpenPopupStack[open - 1]) || ui->key_modifiers != 0 ||
        ui->input.typing || ui->key != cwi_ui_key_number("Escape", nullptr))
        return;
    ImGui::ClosePopupToLevel(open - 1, true);
    ui->input.key_count = 0;
}

/* Closes the modal panels that the frame did not begin, though nobody closed them. */
void shut_modals_not_begun(ImGuiContext &g)
{
    for (int n = 0; n < g.OpenPopupStack.Size; n++)
        if (is_modal(g.OpenPopupStack[n]) &&
            g.OpenPopupStack[n].Window->LastFrameActive < g.FrameCount)
            ImGui::ClosePopupToLevel(n, true);
}

} // namespace

cw_status cwi_ui_imgui_open(cwi_ui *ui, cw_error *err)
{
    if (!has_libgl())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a window needs libGL: apt-get install libgl1");
    ui->imgui = ImGui::CreateContext();
    ImGui::SetCurrentContext(ui->imgui);
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = io.LogFilename = nullptr;
    io.BackendPlatformName = "cubewright";
    io.BackendFlags |=
        ImGuiBackendFlags_HasMouseCursors; /* panels are sized at their borders */
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    io.ClipboardUserData = ui;
    io.GetClipboardTextFn = paste;
    io.SetClipboardTextFn = copy;
    name_keys(io);
    style_all(static_cast<float>(ui->scale));
    add_letters(static_cast<float>(ui->scale));
    if (!ImGui_ImplOpenGL3_Init("#version 330 core") ||
        !ImGui_ImplOpenGL3_CreateDeviceObjects())
        return cwi_fail(err, CW_ERR_BACKEND, "Dear ImGui found no use for this OpenGL");
    return CW_OK;
}

void cwi_ui_imgui_close(cwi_ui *ui)
{
    if (!ui->imgui)
        return;
    ImGui::SetCurrentContext(ui->imgui);
    if (ImGui::GetIO().BackendRendererUserData)
        ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext(ui->imgui);
    ui->imgui = nullptr;
}

void cwi_ui_imgui_choose(cwi_ui *ui)
{
    ImGui::SetCurrentContext(ui->imgui);
}

/* Forgets what was typed. Else ImGui, when a text gets a new content, would undo typing in the
 * previous one, and would write before and behind the new one. */
static void forget_typed(ImGuiContext *imgui)
{
    if (imgui->InputTextState.ID != imgui->ActiveId)
        imgui->InputTextState.ID = 0;
}

/* A panel by its title; "": the bar. nullptr: it is not there. */
static ImGuiWindow *find_panel(const char *title)
{
    return ImGui::FindWindowByName(*title ? title : "##MainMenuBar");
}

/* Asks ImGui for the first widget of the panel, which is then laid out. */
static void begin_walk(cwi_ui *ui)
{
    ImGuiContext &g = *ui->imgui;
    ImGuiWindow *window = find_panel(ui->walked);
    ui->begins_walk = false;
    if (!window)
        return;
    window->Flags &= ~ImGuiWindowFlags_NoNav; /* those of its last frame */
    ImGui::FocusWindow(window);
    g.NavLayer = *ui->walked ? ImGuiNavLayer_Main : ImGuiNavLayer_Menu;
    ImGui::NavInitWindow(window, true);
    g.NavDisableMouseHover = true;
}

/* While keys walk through widgets, all but those that end it are ImGui's. */
static void walk_by_keys(cwi_ui *ui)
{
    ImGuiContext &g = *ui->imgui;
    if (!ui->by_keyboard)
        return;
    if (ui->begins_walk)
        begin_walk(ui);
    const bool is_idle = g.OpenPopupStack.Size == 0 && g.ActiveId == 0;
    const int escape = cwi_ui_key_number("Escape", nullptr),
              end = cwi_ui_key_number("F6", nullptr);
    if (ui->key == end || (ui->key == escape && is_idle))
        ui->by_keyboard = false;
    if (ui->input.dx == 0 && ui->input.dy == 0)
        g.NavDisableHighlight = false; /* people see at once which widget has the keys */
    ui->input.key_count = 0;
}

void cwi_ui_imgui_write(const char *text)
{
    ImGui::GetIO().AddInputCharactersUTF8(text);
}

void cwi_ui_imgui_begin(cwi_ui *ui)
{
    ImGuiIO &io = ImGui::GetIO();
    const double step = ui->time - ui->before;
    if (ui->by_keyboard)
        io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    else
        io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
    io.DeltaTime = static_cast<float>(step > 1e-4 ? step : 1e-4);
    io.DisplaySize =
        ImVec2(static_cast<float>(ui->input.width), static_cast<float>(ui->input.height));
    tell_mouse(ui, io);
    tell_keys(ui, io);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    forget_typed(ui->imgui);
    ui->input.over_widget = io.WantCaptureMouse;
    walk_by_keys(ui);
    ui->input.typing = io.WantTextInput && ui->imgui->ActiveId; /* ImGui is a frame late */
    if (ui->input.typing)
        ui->input.key_count = 0;
    shut_by_escape(ui);
}

void cwi_ui_imgui_layout(cwi_ui *ui)
{
    shut_modals_not_begun(*ui->imgui);
    if (ui->input.typing)
        ui->wake = 0.2; /* the caret blinks */
    if (ui->imgui->DimBgRatio > 0 && ui->imgui->DimBgRatio < 1)
        ui->wake = 0.02; /* it grows dark behind a modal panel */
    ImGui::Render();
}

void cwi_ui_imgui_draw(void)
{
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

int cwi_ui_imgui_cursor(const cwi_ui *ui)
{
    switch (ImGui::GetMouseCursor()) {
    case ImGuiMouseCursor_TextInput:
        return 4;
    case ImGuiMouseCursor_ResizeNS:
        return 5;
    case ImGuiMouseCursor_ResizeEW:
    case ImGuiMouseCursor_ResizeNWSE:
        return 3;
    default:
        return ui->cursor;
    }
}

void cwi_ui_imgui_theme(cwi_ui *ui, cwi_ui_theme theme)
{
    ImGui::SetCurrentContext(ui->imgui);
    if (theme != ui->theme)
        color_all(theme);
    ui->theme = theme;
}

void cwi_ui_imgui_focus(cwi_ui *ui, const char *panel)
{
    ImGui::SetCurrentContext(ui->imgui);
    ui->by_keyboard = panel && find_panel(panel);
    ui->begins_walk = ui->by_keyboard;
    if (ui->by_keyboard)
        snprintf(ui->walked, sizeof ui->walked, "%s", panel);
    ui->settle = 3;
}

bool cwi_ui_imgui_focused(const cwi_ui *ui)
{
    return ui->by_keyboard;
}
