"use strict";
// The page that is read stands in sight in the list of pages.
addEventListener("load", () => {
  const here = document.querySelector(".sidebar-tree .current-page");
  const list = document.querySelector(".sidebar-scroll");
  if (here && list) list.scrollTop += here.getBoundingClientRect().top - list.clientHeight / 2;
});
