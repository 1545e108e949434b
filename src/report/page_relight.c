/* SPDX-License-Identifier: Apache-2.0
 *
 * Relighting by hand: what lies in relight/, one picture for each lamp and view, summed in the
 * browser. Linear sums, then exposure, then sRGB or the colours of the luminance's logarithm.
 */
#include "report/page.h"

static const char *const script[] = {
    "(()=>{const box=document.getElementById('relight');if(!box)return;",
    "const lamps=[...box.querySelectorAll('.lamp')],views=[...box.querySelectorAll('canvas')];",
    "const linear=x=>x<=.04045?x/12.92:((x+.055)/1.055)**2.4;",
    "const srgb=new Uint8ClampedArray(4097);", "for(let i=0;i<=4096;i++){const x=i/4096;",
    "srgb[i]=255*(x<=.0031308?12.92*x:1.055*x**(1/2.4)-.055)+.5}",
    "const encode=x=>srgb[x>=1?4096:x>0?Math.round(x*4096):0];",
    /* Mantissas above, their exponent below. */
    "const decode=(img,w,h)=>{const c=document.createElement('canvas');c.width=w;c.height=2*h;",
    "const g=c.getContext('2d',{willReadFrequently:true});g.drawImage(img,0,0);",
    "const d=g.getImageData(0,0,w,2*h).data,n=w*h,out=new Float32Array(3*n);",
    "for(let i=0;i<n;i++){const e=d[4*(n+i)],s=e?2**(e-136):0;",
    "for(let k=0;k<3;k++)out[3*i+k]=(d[4*i+k]+.5)*s}return out};",
    "const pictures=views.map(()=>[]);", "const draw=()=>{",
    "const ev=+box.querySelector('.exposure').value,x=2**ev*box.dataset.exposure;",
    "const heat=box.querySelector('.how').value==='heat';",
    "const gains=lamps.map(l=>{const p=+l.querySelector('.power').value;",
    "l.querySelector('output').textContent=p.toFixed(2)+'\\u00d7';",
    "const c=l.querySelector('.colour').value;",
    "return[1,3,5].map(k=>p*linear(parseInt(c.slice(k,k+2),16)/255))});",
    "views.forEach((canvas,v)=>{const w=canvas.width,h=canvas.height,n=w*h;",
    "const "
    "g=canvas.getContext('2d',{willReadFrequently:true}),image=g.createImageData(w,h),to=image."
    "data;",
    "const sum=new Float32Array(3*n);", "gains.forEach((gain,l)=>{const from=pictures[v][l];",
    "for(let i=0;i<3*n;i+=3)for(let k=0;k<3;k++)sum[i+k]+=gain[k]*from[i+k]});",
    "for(let i=0;i<n;i++){const r=sum[3*i],y=sum[3*i+1],b=sum[3*i+2];let rgb;",
    "if(heat){const t=1+Math.log2((.2126*r+.7152*y+.0722*b)*x+1e-9)/8;",
    "const a=8*Math.min(1,Math.max(0,t)),j=Math.min(7,Math.floor(a));",
    "rgb=[0,1,2].map(k=>ramp[j][k]+(a-j)*(ramp[j+1][k]-ramp[j][k]))}",
    "else rgb=[encode(r*x),encode(y*x),encode(b*x)];",
    "for(let k=0;k<3;k++)to[4*i+k]=rgb[k];to[4*i+3]=255}", "g.putImageData(image,0,0)});",
    "box.querySelector('.legend').hidden=!heat;",
    "box.querySelector('.ev').textContent=(ev>0?'+':'')+ev.toFixed(1)+' EV';",
    "box.dataset.drawn=String(1+ +(box.dataset.drawn||0))};", "addEventListener('load',()=>{",
    "for(const img of box.querySelectorAll('img')){const at=img.parentElement.dataset;",
    "const c=views[+at.view];pictures[+at.view][+at.lamp]=decode(img,c.width,c.height)}",
    "draw();box.addEventListener('input',draw)})})();", NULL};

static igi_status print_basis(const igi_page *page, size_t view, size_t lamp)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(page->ctx, &path, "%s/relight/%zu.%zu.png", page->folder, view, lamp));
    fprintf(page->file, "<span hidden data-view=\"%zu\" data-lamp=\"%zu\">", view, lamp);
    igi_status status = igi_page_png_file(page, path, "");
    fputs("</span>", page->file);
    igi_free(path);
    return status;
}

static void print_lamp(const igi_page *page, const json_t *lamp, size_t number)
{
    FILE *f = page->file;
    const char *name = json_string_value(json_object_get(lamp, "name"));
    fputs("<div class=\"lamp\"><label><span>", f);
    igi_page_text(page, name ? name : "lamp");
    fprintf(f,
            " <output></output></span><input type=\"range\" class=\"power\" min=\"0\" max=\"4\" "
            "step=\"0.01\" value=\"1\"></label><label><span class=\"soft\">colour</span> "
            "<input type=\"color\" class=\"colour\" value=\"#ffffff\" aria-label=\"colour of lamp "
            "%zu\"></label></div>\n",
            number + 1);
}

static void print_controls(const igi_page *page, const json_t *lamps)
{
    FILE *f = page->file;
    for (size_t i = 0; i < json_array_size(lamps); i++)
        print_lamp(page, json_array_get(lamps, i), i);
    fputs("<div class=\"control\"><label><span>exposure <span class=\"ev\"></span></span><input "
          "type=\"range\" class=\"exposure\" min=\"-6\" max=\"6\" step=\"0.1\" value=\"0\"></label>"
          "<label><span class=\"soft\">show</span> <select class=\"how\"><option "
          "value=\"picture\">picture</option><option value=\"heat\">luminance</option></select>"
          "</label></div><div class=\"legend\" hidden><div class=\"ramp\" "
          "style=\"background:linear-gradient(90deg",
          f);
    for (int i = 0; i < IGI_RAMP_STOPS; i++)
        fprintf(f, ",rgb(%d,%d,%d)", igi_ramp_heat[i][0], igi_ramp_heat[i][1], igi_ramp_heat[i][2]);
    fputs(")\"></div><div class=\"ends\"><span>1/256 of white</span><span>1/16</span><span>white"
          "</span></div></div>",
          f);
}

static void print_script(const igi_page *page)
{
    FILE *f = page->file;
    fputs("<script>\n'use strict';const ramp=[", f);
    for (int i = 0; i < IGI_RAMP_STOPS; i++)
        fprintf(f, "[%d,%d,%d],", igi_ramp_heat[i][0], igi_ramp_heat[i][1], igi_ramp_heat[i][2]);
    fputs("];\n", f);
    for (const char *const *line = script; *line; line++) fprintf(f, "%s\n", *line);
    fputs("</script>", f);
}

igi_status igi_page_relight(const igi_page *page)
{
    FILE *f = page->file;
    const json_t *lamps = json_object_get(page->relight, "lights");
    const json_t *views = json_object_get(page->relight, "views");
    fprintf(
        f,
        "<section id=\"relight\" data-exposure=\"%.9g\"><h2>Relight by hand</h2><p "
        "class=\"soft\">Light adds up: each lamp's picture is its own, rendered by path tracing "
        "with the recovered materials, and the sliders weigh them. Powers are relative to the "
        "recovered lights, a colour multiplies.</p><div class=\"card\">",
        json_number_value(json_object_get(page->relight, "exposure")));
    print_controls(page, lamps);
    fputs("</div><div class=\"wide\">", f);
    for (size_t v = 0; v < json_array_size(views); v++) {
        const json_t *view = json_array_get(views, v);
        const char *name = json_string_value(json_object_get(view, "frame"));
        fprintf(f, "<figure><canvas width=\"%d\" height=\"%d\"></canvas><figcaption>",
                (int)json_integer_value(json_object_get(view, "width")),
                (int)json_integer_value(json_object_get(view, "height")));
        igi_page_text(page, name ? name : "");
        fputs("</figcaption>", f);
        for (size_t l = 0; l < json_array_size(lamps); l++) IGI_TRY(print_basis(page, v, l));
        fputs("</figure>\n", f);
    }
    fputs("</div>", f);
    print_script(page);
    fputs("</section>\n", f);
    return IGI_OK;
}
