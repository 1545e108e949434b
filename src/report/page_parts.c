/* SPDX-License-Identifier: Apache-2.0
 *
 * What every page is made of: head and foot, text, pictures inside, whole or not at all.
 */
#include "report/page.h"

#include "base/file.h"

#include <errno.h>
#include <math.h>
#include <string.h>

void igi_page_text(const igi_page *page, const char *text)
{
    igi_put_escaped(page->file, text);
}

static void print_base64(FILE *f, const uint8_t *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char block[4096];
    size_t at = 0;
    for (size_t i = 0; i < size; i += 3) {
        uint32_t triple = (uint32_t)bytes[i] << 16;
        if (i + 1 < size) triple |= (uint32_t)bytes[i + 1] << 8;
        if (i + 2 < size) triple |= bytes[i + 2];
        block[at++] = digits[triple >> 18];
        block[at++] = digits[triple >> 12 & 63];
        block[at++] = i + 1 < size ? digits[triple >> 6 & 63] : '=';
        block[at++] = i + 2 < size ? digits[triple & 63] : '=';
        if (at == sizeof block || i + 3 >= size) {
            fwrite(block, 1, at, f);
            at = 0;
        }
    }
}

static void put_png(const igi_page *page, const uint8_t *bytes, size_t size, const char *label)
{
    fputs("<img alt=\"", page->file);
    igi_page_text(page, label);
    fputs("\" src=\"data:image/png;base64,", page->file);
    print_base64(page->file, bytes, size);
    fputs("\">", page->file);
}

igi_status igi_page_png_file(const igi_page *page, const char *path, const char *label)
{
    igi_status status = IGI_OK;
    uint8_t *bytes = NULL;
    size_t size = 0, capacity = 0;
    FILE *file = fopen(path, "rb");
    if (!file)
        IGI_TRY_GOTO(igi_fail(page->ctx, IGI_E_SYSTEM, "%s: cannot be read (%s); recover again",
                              path, strerror(errno)));
    for (size_t n = 1; n > 0; size += n) {
        uint8_t *grown = igi_grow(page->ctx, bytes, &capacity, size + 65536, 1);
        if (!grown) IGI_TRY_GOTO(IGI_E_SYSTEM);
        bytes = grown;
        n = fread(bytes + size, 1, 65536, file);
    }
    put_png(page, bytes, size, label);
cleanup:
    if (file) fclose(file);
    igi_free(bytes);
    return status;
}

void igi_page_percent(const igi_page *page, double fraction)
{
    double percent = 100 * fraction;
    if (!isfinite(percent)) fputs("&ndash;", page->file);
    else
        fprintf(page->file, "%.*f&nbsp;%%",
                percent < 1     ? 3
                : percent < 10  ? 2
                : percent < 100 ? 1
                                : 0,
                percent);
}

igi_status igi_page_pixels(const igi_page *page, const uint8_t *pixels, int width, int height,
                           int channels, const char *label)
{
    uint8_t *bytes;
    size_t length;
    IGI_TRY(igi_image_encode_png(page->ctx, pixels, width, height, channels, &bytes, &length));
    put_png(page, bytes, length, label);
    igi_image_free_bytes(bytes);
    return IGI_OK;
}

void igi_page_begin(const igi_page *page, const char *name, const char *lead)
{
    FILE *f = page->file;
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
          "name=\"viewport\" "
          "content=\"width=device-width,initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n"
          "<title>",
          f);
    igi_page_text(page, name);
    fputs(" &middot; igi</title>\n<style>\n", f);
    for (const char *const *line = igi_page_style; *line; line++) fprintf(f, "%s\n", *line);
    fputs("</style></head><body><main>\n<header><p class=\"kicker\">igi &middot; inverse global "
          "illumination</p><h1>",
          f);
    igi_page_text(page, name);
    fputs("</h1><p class=\"lead\">", f);
    igi_page_text(page, lead);
    fputs("</p></header>\n", f);
}

void igi_page_end(const igi_page *page)
{
    fputs("</main>\n<script>\n", page->file);
    for (const char *const *line = igi_page_script; *line; line++)
        fprintf(page->file, "%s\n", *line);
    fputs("</script></body></html>\n", page->file);
}

igi_status igi_page_write(igi_page *page, const char *path, igi_page_fn print, const void *user)
{
    igi_file file;
    igi_srgb_make(&page->srgb);
    IGI_TRY(igi_file_begin(page->ctx, path, &file));
    page->file = file.stream;
    igi_status status = print(page, user);
    page->file = NULL;
    return igi_file_end(page->ctx, &file, status);
}
