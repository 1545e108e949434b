/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs against predictions.
 */
#include "report/page.h"

#include <math.h>

static igi_status print_image(const igi_page *page, const char *file, const char *kind,
                              const char *label)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(page->ctx, &path, "%s/comparison/%s.%s.png", page->folder, file, kind));
    igi_status status = igi_page_png_file(page, path, label);
    igi_free(path);
    return status;
}

static igi_status print_view(const igi_page *page, const json_t *view)
{
    FILE *f = page->file;
    const char *frame = json_string_value(json_object_get(view, "frame"));
    const char *file = json_string_value(json_object_get(view, "file"));
    const json_t *median = json_object_get(view, "median_difference");
    if (!frame || !file) return IGI_OK;
    fputs("<div class=\"card view\"><figure><div class=\"wipe\"><span class=\"a\">photograph</span>"
          "<span class=\"b\">prediction</span>",
          f);
    IGI_TRY(print_image(page, file, "photo", "photograph"));
    IGI_TRY(print_image(page, file, "prediction", "prediction"));
    fputs(
        "</div><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"photograph or "
        "prediction\"><figcaption>Photograph ",
        f);
    igi_page_text(page, frame);
    fputs("</figcaption></figure><figure>", f);
    IGI_TRY(print_image(page, file, "difference", "difference"));
    fputs("<figcaption>Difference, prediction less photograph; its median size is ", f);
    igi_page_percent(page, json_is_number(median) ? json_number_value(median) : (double)NAN);
    fputs(", the photograph's own noise included</figcaption></figure></div>\n", f);
    return IGI_OK;
}

/* The view that shows the most regions; NULL when none has a picture of its albedo. */
static const json_t *richest(const json_t *views)
{
    const json_t *best = NULL;
    json_int_t most = -1;
    for (size_t i = 0; i < json_array_size(views); i++) {
        const json_t *view = json_array_get(views, i);
        json_int_t regions = json_integer_value(json_object_get(view, "regions"));
        if (!json_is_true(json_object_get(view, "albedo")) || regions <= most) continue;
        best = view;
        most = regions;
    }
    return best;
}

igi_status igi_page_first_view(const igi_page *page)
{
    FILE *f = page->file;
    const json_t *view = richest(json_object_get(page->comparisons, "views"));
    const char *frame = json_string_value(json_object_get(view, "frame"));
    const char *file = json_string_value(json_object_get(view, "file"));
    if (!frame || !file) return IGI_OK;
    fputs("<figure>", f);
    IGI_TRY(print_image(page, file, "photo", "a photograph of the room"));
    fputs("<figcaption>Photograph ", f);
    igi_page_text(page, frame);
    fputs("</figcaption></figure><figure>", f);
    IGI_TRY(print_image(page, file, "albedo", "the same view of the recovered albedo"));
    fputs("<figcaption>Its albedo: the room without its light (lamps white)</figcaption></figure>",
          f);
    return IGI_OK;
}

igi_status igi_page_views(const igi_page *page)
{
    const json_t *views = json_object_get(page->comparisons, "views");
    double limit = 100 * json_number_value(json_object_get(page->comparisons, "limit"));
    fprintf(
        page->file,
        "<section id=\"views\"><h2>Photograph against prediction</h2><p class=\"soft\">Left of the "
        "line the "
        "photograph, right of it what the recovered materials send to the camera under the "
        "recovered light. A small difference alone proves nothing: wrong albedos can predict "
        "right pictures of the same light.</p><div style=\"max-width:26rem\"><div class=\"ramp\" "
        "style=\"background:linear-gradient(90deg,#2166ac,#4393c3,#92c5de,#d1e5f0,#f7f7f7,"
        "#fddbc7,#f4a582,#d6604d,#b2182b)\"></div><div class=\"ends\"><span>&minus;%g&nbsp;%%: "
        "predicted too dark</span><span>0</span><span>too bright: +%g&nbsp;%%</span></div>"
        "<p class=\"soft\">Grey: not predicted, because no photograph determines it.</p>"
        "</div>\n",
        limit, limit);
    for (size_t i = 0; i < json_array_size(views); i++)
        IGI_TRY(print_view(page, json_array_get(views, i)));
    fputs("</section>\n", page->file);
    return IGI_OK;
}
