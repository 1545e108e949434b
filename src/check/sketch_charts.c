/* SPDX-License-Identifier: Apache-2.0
 *
 * Small charts: one mark for each photograph.
 */
#include "check/sketch.h"

enum { WIDTH = 340, HEIGHT = 150, LEFT = 52, RIGHT = 8, TOP = 10, BOTTOM = 26 };

static double x_of(size_t i, size_t count)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * ((double)i + .5) / (double)(count ? count : 1);
}

/* A frame with the axis from `low` to `high`, labelled in per cent. */
static void open_chart(const igi_sketch *s, double low, double high, const char *label)
{
    FILE *f = s->page->file;
    fprintf(f, "<svg class=\"chart\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"%s\">", WIDTH,
            HEIGHT, label);
    for (int k = 0; k <= 2; k++) {
        double y = TOP + (HEIGHT - TOP - BOTTOM) * k / 2.0;
        double value = high + (low - high) * k / 2;
        fprintf(f,
                "<line class=\"axis\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/><text x=\"%d\" "
                "y=\"%.1f\" text-anchor=\"end\">%s%.3g&#8201;%%</text>",
                LEFT, WIDTH - RIGHT, y, y, LEFT - 6, y + 4, value > 0 && low < 0 ? "+" : "",
                100 * value);
    }
    fprintf(f, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">photographs, in order</text>",
            (LEFT + WIDTH) / 2, HEIGHT - 6);
}

static double y_of(double value, double low, double high)
{
    double t = fmin(1, fmax(0, (value - low) / (high - low)));
    return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * t;
}

/* What ends at a glance: 1, 2 or 5 times a power of ten. */
static double round_up(double x)
{
    double power = pow(10, floor(log10(fmax(x, 1e-9)))), digits = x / power;
    return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

static void title(const igi_sketch *s, const igi_photo_check *p)
{
    fputs("<title>", s->page->file);
    igi_page_text(s->page, p->name);
    fputs("</title>", s->page->file);
}

void igi_chart_contradictions(const igi_sketch *s)
{
    const igi_check *check = s->c->check;
    double most = 0.01;
    for (size_t i = 0; i < check->photo_count; i++) most = fmax(most, check->photos[i].contradicts);
    most = fmin(1, round_up(most));
    open_chart(s, 0, most, "share of places at which each photograph is alone");
    double width = fmin(14, 0.7 * (x_of(1, check->photo_count) - x_of(0, check->photo_count)));
    for (size_t i = 0; i < check->photo_count; i++) {
        const igi_photo_check *p = &check->photos[i];
        double y = y_of(p->contradicts, 0, most);
        fprintf(s->page->file,
                "<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\">",
                p->left_out ? "bad" : "good", x_of(i, check->photo_count) - width / 2, y, width,
                fmax(1, HEIGHT - BOTTOM - y));
        title(s, p);
        fputs("</rect>", s->page->file);
    }
    fputs("</svg>", s->page->file);
}

void igi_chart_gains(const igi_sketch *s)
{
    const igi_check *check = s->c->check;
    double most = 0.005;
    for (size_t i = 0; i < check->photo_count; i++)
        most = fmax(most, fabs(check->photos[i].gain - 1) + 2 * check->photos[i].gain_error);
    most = round_up(fmin(most, 1));
    open_chart(s, -most, most, "gain of each photograph against the others");
    for (size_t i = 0; i < check->photo_count; i++) {
        const igi_photo_check *p = &check->photos[i];
        double x = x_of(i, check->photo_count), gain = p->gain - 1, sigma = 2 * p->gain_error;
        const char *kind = p->scaled || p->left_out ? "bad" : "good";
        fprintf(s->page->file,
                "<line class=\"%s\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/><circle "
                "class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"3\">",
                kind, x, x, y_of(gain - sigma, -most, most), y_of(gain + sigma, -most, most), kind,
                x, y_of(gain, -most, most));
        title(s, p);
        fputs("</circle>", s->page->file);
    }
    fputs("</svg>", s->page->file);
}

void igi_chart_offsets(const igi_sketch *s)
{
    const igi_check *check = s->c->check;
    FILE *f = s->page->file;
    double most = 0.5;
    for (size_t i = 0; i < check->photo_count; i++)
        most = fmax(most, hypot(check->photos[i].offset[0], check->photos[i].offset[1]));
    most = round_up(most);
    double scale = 92 / most;
    fputs("<svg class=\"chart\" viewBox=\"-170 -105 340 225\" role=\"img\" aria-label=\"offset of "
          "each photograph's edges from the mesh's\">",
          f);
    for (int k = 1; k <= 2; k++)
        fprintf(f,
                "<circle class=\"axis\" r=\"%.1f\"/><text x=\"4\" y=\"%.1f\">%.3g&#8201;px</text>",
                46.0 * k, -46.0 * k + (k == 2 ? 13 : -4), most * k / 2);
    fputs("<path class=\"axis\" d=\"M-100 0H100M0 -100V100\"/>", f);
    for (size_t i = 0; i < check->photo_count; i++) {
        const igi_photo_check *p = &check->photos[i];
        const char *kind = s->c->faults->frames[i].off || s->c->faults->all_off ? "bad" : "good";
        double x = scale * p->offset[0], y = scale * p->offset[1];
        if (p->edges == 0) continue;
        fprintf(f,
                "<circle class=\"axis\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/><line class=\"%s\" "
                "x2=\"%.1f\" y2=\"%.1f\"/><circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"3\">",
                x, y, fmin(200, 2 * scale * p->offset_error), kind, x, y, kind, x, y);
        title(s, p);
        fputs("</circle>", f);
    }
    fputs("<text y=\"116\" text-anchor=\"middle\">an arrow for each photograph, with its "
          "2&#8201;&sigma;</text></svg>",
          f);
}

/* Bars on a logarithmic axis from 1 to 100. */
void igi_chart_growth(const igi_sketch *s)
{
    FILE *f = s->page->file;
    const char *const names[] = {"relit pictures", "unseen surfaces"};
    const double growth[] = {s->c->check->amplification, s->c->check->unseen_condition};
    fprintf(f,
            "<svg class=\"chart\" viewBox=\"0 0 %d 120\" role=\"img\" aria-label=\"how errors "
            "grow\">",
            WIDTH);
    for (int k = 0; k <= 2; k++) {
        double x = 110 + 105.0 * k;
        fprintf(f,
                "<line class=\"axis\" x1=\"%.0f\" x2=\"%.0f\" y1=\"8\" y2=\"92\"/><text "
                "x=\"%.0f\" y=\"110\" text-anchor=\"middle\">&times;%.0f</text>",
                x, x, x, pow(10, k));
    }
    for (int k = 0; k < 2; k++) {
        double t = fmin(2, log10(fmax(1, growth[k])));
        fprintf(f, "<text x=\"102\" y=\"%d\" text-anchor=\"end\">%s</text>", 36 + 38 * k, names[k]);
        if (isnan(growth[k])) continue;
        fprintf(f,
                "<rect class=\"%s\" x=\"110\" y=\"%d\" width=\"%.1f\" height=\"22\"/><text "
                "x=\"%.1f\" y=\"%d\">&times;%.2f</text>",
                growth[k] > 10 ? "bad" : "good", 20 + 38 * k, fmax(2, 105 * t), 116 + 105 * t,
                36 + 38 * k, growth[k]);
    }
    fputs("</svg>", f);
}
