/* SPDX-License-Identifier: Apache-2.0
 *
 * A picture of what a lens leaves: at every corner a line to where it was seen from where it was
 * expected, magnified, and each view's RMS as a bar. A lens of too few numbers shows as lines that turn
 * with the place, a bad view as red ones.
 */
#include "base/file.h"
#include "lens/lens_private.h"

#include <math.h>

#define FRAME 640.0 /* width of the photograph's outline */
#define BARS 300.0  /* and of the bars beside it */
#define ROW 18.0
#define MARGIN 12.0

typedef struct drawing {
    FILE *to;
    const igi_calibration *c;
    double scale;   /* of the picture for a pixel */
    double magnify; /* of residuals, in pixels */
    double longest; /* RMS of the longest bar */
} drawing;

static const char *colour_of(const igi_calibration_view *view)
{
    return view->used ? "#3465a4" : "#cc0000";
}

/* A power of ten, twice or five times it: the good views' RMS becomes about a fortieth of the width. */
static double round_magnification(double wanted)
{
    double ten = pow(10, floor(log10(wanted)));
    return ten * (wanted >= 5 * ten ? 5 : wanted >= 2 * ten ? 2 : 1);
}

static void draw_text(FILE *to, double x, double y, const char *text)
{
    fprintf(to, "<text x=\"%.1f\" y=\"%.1f\">", x, y);
    igi_put_escaped(to, text);
    fputs("</text>\n", to);
}

static void draw_corners(const drawing *d)
{
    const igi_calibration *c = d->c;
    /* An svg of its own cuts what reaches beyond it. */
    fprintf(d->to,
            "<svg width=\"%.1f\" height=\"%.1f\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"none\" stroke=\"#888\"/>\n",
            c->width * d->scale, c->height * d->scale);
    for (size_t v = 0; v < c->view_count; v++) {
        const igi_calibration_view *view = &c->views[v];
        fprintf(d->to, "<path stroke=\"%s\" fill=\"none\" d=\"", colour_of(view));
        for (size_t i = 0; i < view->corner_count; i++) {
            const double *p = view->corners[i];
            fprintf(d->to, "M%.1f %.1fl%.1f %.1f", (p[0] - p[2]) * d->scale,
                    (p[1] - p[3]) * d->scale, p[2] * d->magnify * d->scale,
                    p[3] * d->magnify * d->scale);
        }
        fputs("\"/>\n", d->to);
    }
    fputs("</svg>\n", d->to);
}

static void draw_bars(const drawing *d)
{
    char text[64];
    for (size_t v = 0; v < d->c->view_count; v++) {
        const igi_calibration_view *view = &d->c->views[v];
        double y = (double)v * ROW, x = FRAME + MARGIN;
        fprintf(d->to,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" "
                "fill-opacity=\".4\"/>\n",
                x, y, BARS * view->rms_px / d->longest, ROW - 4, colour_of(view));
        draw_text(d->to, x + 4, y + ROW - 7, view->file);
        if (view->corner_count)
            snprintf(text, sizeof text, "%.3f px%s", view->rms_px, view->used ? "" : ", left out");
        else snprintf(text, sizeof text, "no board");
        draw_text(d->to, x + BARS / 2, y + ROW - 7, text);
    }
}

static void draw(drawing *d)
{
    const igi_calibration *c = d->c;
    char text[120];
    double height = fmax(c->height * d->scale, (double)c->view_count * ROW) + 2 * ROW;
    for (size_t v = 0; v < c->view_count; v++) d->longest = fmax(d->longest, c->views[v].rms_px);
    fprintf(d->to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"%.1f %.1f %.1f %.1f\" "
            "font-family=\"sans-serif\" font-size=\"11\">\n"
            "<rect x=\"%.1f\" y=\"%.1f\" width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            -MARGIN, -MARGIN, FRAME + BARS + 3 * MARGIN, height + MARGIN, -MARGIN, -MARGIN);
    draw_corners(d);
    draw_bars(d);
    snprintf(text, sizeof text, "residuals %g times as long; rms %.4f px; red: left out",
             d->magnify, c->rms_px);
    draw_text(d->to, 0, height - ROW / 2, text);
    fputs("</svg>\n", d->to);
}

igi_status igi_calibration_draw_residuals(igi_context *ctx, const igi_calibration *calibration,
                                          const char *path)
{
    size_t corners = 0;
    igi_file file;
    for (size_t v = 0; v < calibration->view_count; v++)
        corners += calibration->views[v].corner_count;
    if (corners == 0)
        return igi_fail(ctx, IGI_E_USAGE,
                        "%s: residuals are of a board's corners; calibrate by one first", path);
    IGI_TRY(igi_file_begin(ctx, path, &file));
    drawing d = {.to = file.stream, .c = calibration, .longest = 1e-9};
    d.scale = FRAME / calibration->width;
    d.magnify = round_magnification(calibration->width / 40. / fmax(calibration->rms_px, 1e-3));
    draw(&d);
    return igi_file_end(ctx, &file, IGI_OK);
}
