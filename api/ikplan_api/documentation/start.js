// Starts Swagger UI on the service's own document, at the address this page came from.
const base = new URL(".", document.baseURI);

async function start() {
  const answer = await fetch(new URL("openapi.json", base));
  if (!answer.ok) throw new Error(`openapi.json: status ${answer.status}`);
  const spec = await answer.json();
  // A proxy may put the service under a prefix, which only the browser knows.
  spec.servers = [{ url: base.href.replace(/\/$/, ""), description: "this service" }];
  SwaggerUIBundle({
    spec,
    dom_id: "#swagger-ui",
    deepLinking: true,
    displayRequestDuration: true,
    docExpansion: "list",
    filter: true,
    persistAuthorization: false, // a key stays in this window
    requestSnippetsEnabled: true,
    tryItOutEnabled: true,
    validatorUrl: null, // no document leaves this service
  });
}

start().catch((error) => {
  document.getElementById("swagger-ui").textContent = `The manual cannot be shown: ${error.message}`;
});
