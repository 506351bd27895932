// Search over all sections, from the disk: the index is a script, since pages there may read no other file.
const box = document.querySelector("input[type=search]");
const list = document.getElementById("found");
let sections = null;

window.takeSections = (all) => {
  sections = all.map((section) => ({...section, low: (section.title + " " + section.text).toLowerCase()}));
  show();
};

function show() {
  const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
  list.hidden = words.length === 0;
  list.replaceChildren();
  if (list.hidden || !sections) return;
  const found = sections.filter((section) => words.every((word) => section.low.includes(word)));
  const weight = (section) => words.filter((word) => section.title.toLowerCase().includes(word)).length;
  found.sort((a, b) => weight(b) - weight(a));
  for (const section of found.slice(0, 40)) {
    const link = document.createElement("a");
    link.href = box.dataset.home.replace(/index\.html$/, "") + section.url;
    link.textContent = section.title;
    link.addEventListener("click", () => { list.hidden = true; });
    const at = Math.max(0, section.text.toLowerCase().indexOf(words[0]) - 60);
    const words_around = document.createElement("small");
    words_around.textContent = section.page + ": " + (at > 0 ? "… " : "") + section.text.slice(at, at + 180);
    const item = document.createElement("li");
    item.append(link, words_around);
    list.append(item);
  }
  if (found.length === 0) list.append(Object.assign(document.createElement("li"), {textContent: "Nothing."}));
}

box.form.addEventListener("submit", (event) => event.preventDefault());
box.addEventListener("input", () => {
  if (!sections && !document.getElementById("index")) {
    document.body.append(Object.assign(document.createElement("script"), {id: "index", src: box.dataset.index}));
  }
  show();
});
