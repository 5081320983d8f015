// Looks at the page in the frame `page` as a reader would and writes what it finds, as JSON, into the element `found`.
function look() {
  const page = document.getElementById("page").contentDocument, root = page.documentElement;
  const view = page.defaultView;
  const name = e => (e.closest("figure")?.id ?? e.closest("section")?.querySelector("h2")?.textContent ?? "head") + ": " + e.textContent.trim().slice(0, 30);

  // Colours as [r, g, b, a]; what lies over what; the contrast of WCAG 2.
  const colour = text => { const c = (text.match(/[\d.]+/g) ?? [0, 0, 0, 0]).map(Number); return c.length > 3 ? c : [...c, 1]; };
  const over = (top, below) => top.slice(0, 3).map((c, i) => c * top[3] + below[i] * (1 - top[3]));
  const light = c => { const [r, g, b] = c.map(v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const contrast = (a, b) => { const [x, y] = [light(a), light(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); };
  const ground = e => {
    const drawing = e.closest("figure svg:not(svg svg)");
    const paper = drawing?.querySelector(".ground");
    if (paper) return colour(view.getComputedStyle(paper).fill);
    const layers = [];
    for (let at = e; at; at = at.parentElement) layers.unshift(colour(view.getComputedStyle(at).backgroundColor));
    return layers.reduce((below, top) => over(top, below), [255, 255, 255]);
  };
  const ink = (e, property) => { const g = ground(e), c = colour(view.getComputedStyle(e)[property]); return contrast(over(c, g), g); };

  const holds_text = e => [...e.childNodes].some(n => n.nodeType == 3 && n.textContent.trim());
  const texts = [...page.body.querySelectorAll("*")].filter(e => holds_text(e) && !["TITLE", "STYLE", "SCRIPT"].includes(e.tagName.toUpperCase()));
  const faint_text = texts.filter(e => ink(e, e.closest("svg") ? "fill" : "color") < 4.5).map(e => name(e) + " " + ink(e, e.closest("svg") ? "fill" : "color").toFixed(2));
  const strokes = [...page.querySelectorAll("figure :is(.line,.bar,.frame,.axis,.turn,line)")].filter(e => ink(e, "stroke") < 3);
  const fills = [...page.querySelectorAll("figure .mark")].filter(e => ink(e, "fill") < 3);
  const faint_marks = [...new Set([...strokes, ...fills].map(e => e.closest("figure").id + " ." + e.getAttribute("class")))];

  const width = root.clientWidth;
  const box = e => e.getBoundingClientRect();
  // What scrolls on its own, a wide table or map on a telephone, may reach further.
  const scrolls = e => { for (let at = e.parentElement; at; at = at.parentElement) if (/auto|scroll/.test(view.getComputedStyle(at).overflowX) && box(at).right <= width + 1) return true; return false; };
  const outside = [...page.body.querySelectorAll("*")].filter(e => !e.closest("svg svg") && box(e).width > 0 && (box(e).right > width + 1 || box(e).left < -1) && !scrolls(e)).map(name);
  // Text of a drawing that leaves the drawing, or lies on another text of it.
  const clashes = [], cut = [];
  for (const drawing of page.querySelectorAll("figure svg:not(svg svg)")) {
    const edge = box(drawing), placed = [...drawing.querySelectorAll("text")].map(e => [box(e), e]);
    for (const [b, e] of placed) if (b.left < edge.left - 1 || b.right > edge.right + 1 || b.top < edge.top - 1 || b.bottom > edge.bottom + 1) cut.push(name(e));
    placed.forEach(([a, e], i) => placed.slice(i + 1).forEach(([b, f]) => {
      const [w, h] = [Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top)];
      if (w > 1 && h > 0.35 * Math.min(a.height, b.height)) clashes.push(name(e) + " / " + f.textContent);
    }));
  }

  const size = e => parseFloat(view.getComputedStyle(e).fontSize) * (e.closest("svg") ? box(e.closest("figure svg:not(svg svg)")).width / e.closest("figure svg:not(svg svg)").viewBox.baseVal.width : 1);
  const figures = [...page.querySelectorAll("figure")].map(figure => {
    const drawings = [...figure.querySelectorAll("svg:not(svg svg)")];
    return {
      id: figure.id,
      caption: figure.querySelector("figcaption")?.textContent ?? "",
      drawings: drawings.map(e => ({
        width: e.getBBox().width, height: e.getBBox().height,
        shapes: [...e.querySelectorAll("path,rect,line,polygon")].filter(s => { const b = s.getBBox(); return b.width + b.height > 0; }).length,
        data: e.querySelectorAll(".mark,.line,.found,polygon,rect.p,rect.n").length,
        hover: [...e.querySelectorAll("g > title, rect > title")].filter(t => /\d/.test(t.textContent)).length,
        label: e.getAttribute("aria-label") ?? "",
      })),
      smallest_text: Math.min(...[...figure.querySelectorAll("text")].map(size)),
    };
  });
  const ground_of_page = view.getComputedStyle(page.body).backgroundColor;
  document.getElementById("found").textContent = JSON.stringify({
    figures, faint_text, faint_marks, outside, clashes, cut, ground: light(colour(ground_of_page)),
    width: root.scrollWidth, client: width, texts: texts.length,
  });
}
