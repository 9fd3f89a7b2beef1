"use strict";
addEventListener("load", () => {
  // The page that is read stands in sight in the list of pages.
  const here = document.querySelector(".sidebar-tree .current-page");
  const list = document.querySelector(".sidebar-scroll");
  if (here && list) list.scrollTop += here.getBoundingClientRect().top - list.clientHeight / 2;
  // What screen readers and keyboards need, and the theme does not write.
  for (const caption of document.querySelectorAll("p.caption[role=heading]")) caption.setAttribute("aria-level", "2");
  document.querySelector("aside.sidebar-drawer")?.setAttribute("aria-label", "Pages");
  document.querySelector("aside.toc-drawer")?.setAttribute("aria-label", "On this page");
  for (const code of document.querySelectorAll(".highlight pre")) code.tabIndex = 0;
});
